#include "models/capture/camera.h"

#include <stdexcept>
#include <string>

#include "models/testing/expected_report.h"
#include "tests/support/scratch_folder.h"
#include "tests/unit/capture/capture_bench.h"

namespace stereotlm::capture {
namespace {

// Takes the frame that the test names.
class Receiver : public StreamIf<VideoFrame> {
 public:
  explicit Receiver(Camera& camera) : camera_(camera) { camera.frames_out.bind(*this); }
  void push(const VideoFrame& frame) override {
    EXPECT_EQ(frame.begin_ps, kernel_time::now_ps());
    EXPECT_EQ(frame.timing, &camera_.timing());
    frames.push_back(frame);
    if (frame.number == takes) camera_.link->take(frame.number);
  }

  std::uint64_t takes = UINT64_MAX;
  std::vector<VideoFrame> frames;

 private:
  Camera& camera_;
};

class CameraTest : public testing::Test {
 protected:
  void build(CameraTrigger trigger, int height = 5) {
    camera.emplace("camera", CameraConfig{8, height, 29.97, trigger}, source);
    receiver.emplace(*camera);
  }
  void trigger(std::uint64_t delay_ps = 0) { camera->link->trigger(kernel_time::now_ps() + delay_ps); }
  std::uint64_t frame_ps(std::uint64_t number) const { return camera->timing().frame_ps(number); }
  std::size_t frames_by(std::uint64_t time_ps) const {
    run_to(time_ps);
    return receiver->frames.size();
  }
  std::uint64_t ignored() const { return camera->stats().ignored_triggers; }

  NoiseSource source{8, 5};
  std::optional<Camera> camera;
  std::optional<Receiver> receiver;
};

TEST_F(CameraTest, BeginsItsFramesWithTheFrameClockAndAsksForNoPictureOfAFrameThatIsNotTaken) {
  build(CameraTrigger::kFreeRunning);
  EXPECT_EQ(frames_by(frame_ps(3) - 1), 3U);
  ASSERT_EQ(frames_by(frame_ps(3)), 4U);
  for (std::uint64_t i = 0; i < 4; ++i) {
    EXPECT_EQ(receiver->frames[i].number, i);
    EXPECT_EQ(receiver->frames[i].begin_ps, frame_ps(i));
  }
  EXPECT_EQ(camera->stats().frames, 4U);
  EXPECT_TRUE(source.asked.empty());
}

TEST_F(CameraTest, GivesTheWordsOfTheLastFrameTaken) {
  build(CameraTrigger::kFreeRunning);
  receiver->takes = 1;
  run_to(frame_ps(3));
  EXPECT_EQ(source.asked, std::vector<std::uint64_t>{1});
  EXPECT_EQ(source.begins_ps, std::vector<std::uint64_t>{frame_ps(1)});
  std::vector<std::uint32_t> words(3);
  camera->link->copy_words(5, 3, words.data());
  const kernels::GrayImage picture = source.picture(1);
  for (std::size_t word = 0; word < 3; ++word) {
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(words[word] >> (8 * i) & 0xFF, picture.pixels[4 * (5 + word) + i]) << word << ", " << i;
  }
}

TEST_F(CameraTest, BeginsAFrameAtTheTimeOfItsTriggerOnDemand) {
  build(CameraTrigger::kOnDemand);
  EXPECT_EQ(frames_by(1'000), 0U);
  trigger();
  ASSERT_EQ(frames_by(1'000), 1U);
  EXPECT_EQ(receiver->frames[0].number, 0U);
  EXPECT_EQ(receiver->frames[0].begin_ps, 1'000U);
  EXPECT_EQ(frames_by(3 * frame_ps(1)), 1U);
  trigger(500);
  EXPECT_EQ(frames_by(3 * frame_ps(1) + 499), 1U);
  ASSERT_EQ(frames_by(3 * frame_ps(1) + 500), 2U);
  EXPECT_EQ(receiver->frames[1].number, 1U);
  EXPECT_EQ(camera->stats().frames, 2U);
  EXPECT_EQ(ignored(), 0U);
}

TEST_F(CameraTest, IgnoresATriggerForATimeBeforeTheLastPixelOfTheFrame) {
  build(CameraTrigger::kOnDemand);
  const std::uint64_t last_pixel_ps = camera->timing().pixel_ps(7, 4);
  trigger();
  run_to(1'000);
  trigger(last_pixel_ps - 1'001);
  EXPECT_EQ(ignored(), 1U);
  run_to(last_pixel_ps - 1);
  trigger();
  EXPECT_EQ(ignored(), 2U);
  EXPECT_EQ(frames_by(last_pixel_ps), 1U);
  trigger();
  EXPECT_EQ(ignored(), 2U);
  ASSERT_EQ(frames_by(last_pixel_ps), 2U);
  EXPECT_EQ(receiver->frames[1].begin_ps, last_pixel_ps);
  trigger(last_pixel_ps);
  EXPECT_EQ(ignored(), 2U);
  EXPECT_EQ(frames_by(2 * last_pixel_ps), 3U);
}

TEST_F(CameraTest, IgnoresASecondTriggerBeforeTheFrameBegins) {
  build(CameraTrigger::kOnDemand);
  run_to(1'000);
  trigger(700);
  trigger(300);
  EXPECT_EQ(ignored(), 1U);
  EXPECT_EQ(frames_by(1'699), 0U);
  EXPECT_EQ(frames_by(1'700), 1U);
}

TEST_F(CameraTest, IgnoresATriggerWhenItRunsFreely) {
  build(CameraTrigger::kFreeRunning);
  run_to(1'000);
  trigger();
  EXPECT_EQ(frames_by(frame_ps(2)), 3U);
  EXPECT_EQ(ignored(), 1U);
}

TEST_F(CameraTest, ReportsAPictureOfAnotherSize) {
  build(CameraTrigger::kFreeRunning, 6);
  run_to(1);
  test::ExpectedReport expected("/stereotlm/camera");
  EXPECT_THROW(camera->link->take(0), sc_core::sc_report);
  EXPECT_EQ(expected.text(), "camera: picture of frame 0 = 8 x 5: must be 8 x 6");
}

TEST_F(CameraTest, ReportsAFrameThatIsNotRunningOrTakenTwice) {
  build(CameraTrigger::kFreeRunning);
  run_to(frame_ps(1));
  test::ExpectedReport expected("/stereotlm/camera", 3);
  EXPECT_THROW(camera->link->take(0), sc_core::sc_report);
  EXPECT_THROW(camera->link->take(2), sc_core::sc_report);
  camera->link->take(1);
  EXPECT_THROW(camera->link->take(1), sc_core::sc_report);
  EXPECT_EQ(expected.text(), "camera: frame 1 taken: must be the running one, once; 2 have begun");
}

TEST_F(CameraTest, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(Camera("refused", CameraConfig{8, 5, 2000, CameraTrigger::kFreeRunning}, source),
               std::invalid_argument);
}

TEST(CameraResolution, MustBeOnePicosecond) {
  sc_core::sc_set_time_resolution(10, sc_core::SC_PS);
  NoiseSource source(8, 5);
  const std::string text = test::message_of([&] {
    Camera("refused", CameraConfig{8, 5, 25, CameraTrigger::kFreeRunning}, source);
  });
  EXPECT_EQ(text,
            "refused: time resolution = 10 ps: must be 1 ps, SystemC's default: leave "
            "sc_set_time_resolution() out, or call it with (1, SC_PS)");
}

}  // namespace
}  // namespace stereotlm::capture
