// The whole computer, with the driver on its processor and every memory-mapped link under the monitor. The
// boards are small, and their cameras as fast in proportion to the core as those of the paper's board.
#include "platform/computer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>
#include <vector>

#include "models/fpga/core_control.h"
#include "models/kernels/stereo.h"
#include "platform/config/tables.h"
#include "sw/driver/board_driver.h"
#include "tests/support/monitoring_binder.h"
#include "tests/support/noise_picture.h"
#include "tests/support/random_board.h"

namespace stereotlm {
namespace {

using kernels::GrayImage;
using platform::BoardConfig;

// Camera frame k of one side: noise of its own, the left side shifted by a few pixels.
class NoiseSource : public capture::CameraSource {
 public:
  NoiseSource(const BoardConfig& board, int shift)
      : shift_(shift), image_(board.image.width, board.image.height) {}
  const GrayImage& frame(std::uint64_t number, std::uint64_t /*begin_ps*/) override {
    image_ = picture(number);
    return image_;
  }
  GrayImage picture(std::uint64_t number) const {
    return test::noise_picture(image_.width, image_.height, number, shift_);
  }

 private:
  int shift_;
  GrayImage image_;
};

class Deliveries : public driver::FrameListener {
 public:
  explicit Deliveries(const BoardConfig& board)
      : pixels_(static_cast<std::size_t>(board.image.width * board.image.height)) {}
  void frame_delivered(const driver::DeliveredFrame& frame) override {
    EXPECT_EQ(frame.frame, camera_frames.size());
    camera_frames.push_back(frame.camera_frame);
    disparities.emplace_back(frame.disparity, frame.disparity + pixels_);
    times.push_back(sc_core::sc_time_stamp());
  }
  double steady_fps() const {
    return static_cast<double>(times.size() - 1) / (times.back() - times.front()).to_seconds();
  }
  std::vector<std::uint64_t> camera_frames;
  std::vector<std::vector<std::uint8_t>> disparities;
  std::vector<sc_core::sc_time> times;

 private:
  std::size_t pixels_;
};

// 128 x 80 pixels; the core takes `camera_frames` times the time of a camera frame.
BoardConfig small_board(double camera_frames) {
  BoardConfig board;
  board.image = {128, 80};
  board.matcher.window = 7;
  board.matcher.disparities = 16;
  board.fpga.pipeline_latency_cycles = 16;
  const fpga::FrameGeometry geometry(platform::core_config(board));
  const auto cycles = static_cast<double>(4 + geometry.slots + geometry.drain_cycles + 1 + 16);
  board.cameras.frame_rate_hz = camera_frames * board.fpga.clock_mhz * 1e6 / cycles;
  board.capture.fifo_words = 140;
  return board;
}

class ComputerTest : public testing::Test {
 protected:
  void run(const BoardConfig& config, std::uint64_t frames) {
    board = config;
    tables = platform::identity_tables(board);
    left = std::make_unique<NoiseSource>(board, 0);
    right = std::make_unique<NoiseSource>(board, 5);
    deliveries = std::make_unique<Deliveries>(board);
    const driver::DriverConfig driver_config = driver::driver_config(board, frames);
    const auto entries = [](const std::optional<kernels::RectificationTable>& table) {
      return table ? table->entries : std::vector<std::uint32_t>{};
    };
    driver = std::make_unique<driver::StereoDriver>(driver_config, entries(tables.left),
                                                    entries(tables.right), *deliveries);
    computer = std::make_unique<platform::Computer>(
        "computer", board, driver::host_memory_bytes(driver_config), *driver, *left, *right, binder);
    for (int ms = 0; ms < 1000 && !computer->cpu.finished(); ++ms) sc_core::sc_start(1, sc_core::SC_MS);
    ASSERT_TRUE(computer->cpu.finished());
    ASSERT_EQ(deliveries->times.size(), frames);
  }
  // Each result is that of the pictures which the cameras took for it.
  void expect_results_of_the_captured_pictures() const {
    const kernels::StereoConfig config{board.matcher.window, board.matcher.disparities, board.matcher.filter,
                                       board.matcher.lr_tolerance};
    for (std::size_t frame = 0; frame < deliveries->camera_frames.size(); ++frame) {
      const std::uint64_t camera_frame = deliveries->camera_frames[frame];
      const GrayImage expected = kernels::disparity_image(
          left->picture(camera_frame), right->picture(camera_frame), tables.left ? &*tables.left : nullptr,
          tables.right ? &*tables.right : nullptr, config);
      EXPECT_EQ(deliveries->disparities[frame], expected.pixels) << frame;
    }
  }
  void expect_all_words_accounted_for() const {
    const fpga::LocalBus& local_bus = computer->board.core.local_bus_port();
    EXPECT_EQ(computer->bridge.words_taken().total(), computer->bridge.words_held().total() +
                                                          local_bus.words_to_grant().total() +
                                                          local_bus.words_granted().total());
    EXPECT_EQ(computer->bridge.stats().errors, 0U);
    EXPECT_EQ(local_bus.stats().errors, 0U);
    for (const auto* grabber : {&computer->left_capture, &computer->right_capture}) {
      EXPECT_EQ(grabber->stats().dropped_pixels, 0U);
      EXPECT_EQ(grabber->stats().lost_words, 0U);
    }
  }
  double fps() const { return deliveries->steady_fps(); }
  double camera_fps() const { return board.cameras.frame_rate_hz; }

  test::MonitoringBinder binder;
  BoardConfig board;
  platform::Tables tables;
  std::unique_ptr<NoiseSource> left;
  std::unique_ptr<NoiseSource> right;
  std::unique_ptr<Deliveries> deliveries;
  std::unique_ptr<driver::StereoDriver> driver;
  std::unique_ptr<platform::Computer> computer;
};

constexpr double kWindow7 = 1.6116;  // core time of the paper's board in camera frames, 7 x 7
constexpr double kWindow5 = 1.1536;  // 5 x 5
constexpr double kOnePercent = 0.01;

struct BoardCase {
  const char* name;
  double camera_frames;
  std::uint64_t frames;
  void (*change)(BoardConfig&);
};
void PrintTo(const BoardCase& tested, std::ostream* out) { *out << tested.name; }

class ComputerBoards : public ComputerTest, public testing::WithParamInterface<BoardCase> {};

TEST_P(ComputerBoards, DeliverTheDisparitiesOfTheCapturedPictures) {
  BoardConfig config = small_board(GetParam().camera_frames);
  GetParam().change(config);
  run(config, GetParam().frames);
  expect_results_of_the_captured_pictures();
  expect_all_words_accounted_for();
  if (config.cameras.trigger == platform::CameraTrigger::kFreeRunning) return;
  for (std::uint64_t frame = 0; frame < GetParam().frames; ++frame)
    EXPECT_EQ(deliveries->camera_frames.at(frame), frame);
}

INSTANTIATE_TEST_SUITE_P(
    Boards, ComputerBoards,
    testing::Values(
        BoardCase{"Plain", kWindow7, 12, [](BoardConfig&) {}},
        BoardCase{"CaptureToHostMemory", kWindow7, 12,
                  [](BoardConfig& b) { b.capture.destination = platform::CaptureDestination::kHostMemory; }},
        BoardCase{"CamerasOnDemand", kWindow7, 8,
                  [](BoardConfig& b) { b.cameras.trigger = platform::CameraTrigger::kOnDemand; }},
        BoardCase{"WithoutTables", kWindow7, 5,
                  [](BoardConfig& b) { b.allocation.left_lut = b.allocation.right_lut = std::nullopt; }},
        BoardCase{"AllBuffersInOneBank", 0.2, 5,
                  [](BoardConfig& b) {
                    b.allocation = {{"bank0"}, {"bank0"}, {"bank0"}, "bank0", "bank0"};
                  }}),
    [](const auto& tested) { return tested.param.name; });

TEST_F(ComputerTest, BlamesTheHostForItsTrafficOnABankOfTheCore) {
  BoardConfig config = small_board(kWindow7);
  config.allocation.left_image = {"bank0", "bank0"};
  run(config, 6);
  const auto& arbiter = computer->board.core.crossbar().arbiters()[0];
  EXPECT_GT(arbiter.stats()
                .blame[fpga::pixel_port(fpga::Side::kLeft)][fpga::kHostPort],
            0U);
  expect_results_of_the_captured_pictures();
}

TEST_F(ComputerTest, HasAFifthMasterOnTheBusOnlyWithALoad) {
  run(small_board(kWindow7), 1);
  EXPECT_EQ(computer->traffic_generator, nullptr);
  EXPECT_EQ(computer->pci_bus.stats().masters.size(), 4U);
}

TEST_F(ComputerTest, DeliversTheDisparitiesBesideAThirdPartyOnTheBus) {
  BoardConfig config = small_board(kWindow7);
  config.pci.load = platform::PciLoadConfig{16, 10, 100, 1};
  run(config, 6);
  expect_results_of_the_captured_pictures();
  expect_all_words_accounted_for();
  const auto stats = computer->pci_bus.stats();
  const auto& load = stats.masters.at(platform::Computer::kTrafficGenerator);
  EXPECT_EQ(load.name, "load");
  EXPECT_EQ(load.aborts, 0U);
  const double intervals = (sc_core::sc_time_stamp().to_seconds() * 1e6 - 100) / 10;
  EXPECT_NEAR(static_cast<double>(computer->traffic_generator->transfers()), intervals, 1);
  EXPECT_GE(load.words, computer->traffic_generator->transfers() * 16);
  // Beside the address and data clocks of all masters: the microsecond before each first word, 33 clocks.
  std::uint64_t clocks = computer->traffic_generator->transfers() * 33;
  for (const auto& master : stats.masters) clocks += master.transactions + master.words;
  EXPECT_GE(stats.busy_clocks, clocks);
}

TEST_F(ComputerTest, DeliversTheDisparitiesBesideALoadWithoutPauses) {
  BoardConfig config = small_board(kWindow7);
  config.pci.load = platform::PciLoadConfig{32, 0, 0, 0};
  run(config, 3);
  expect_results_of_the_captured_pictures();
  expect_all_words_accounted_for();
  const auto stats = computer->pci_bus.stats();
  EXPECT_GT(stats.masters.at(platform::Computer::kTrafficGenerator).words, stats.clocks / 2);
}

// Free-running cameras write straight into the idle buffer: a capture waits for the next frame, so that
// frames of the core fall into step with the cameras.
TEST_F(ComputerTest, TakesThreePairsInFiveCameraFramesWithTwoBuffers) {
  run(small_board(kWindow7), 31);
  EXPECT_NEAR(fps() / camera_fps(), 3.0 / 5, kOnePercent * 3 / 5);
}

TEST_F(ComputerTest, TakesTwoPairsInThreeCameraFramesWithAFasterCore) {
  run(small_board(kWindow5), 31);
  EXPECT_NEAR(fps() / camera_fps(), 2.0 / 3, kOnePercent * 2 / 3);
}

TEST_F(ComputerTest, TakesAPairInThreeCameraFramesWithOneBuffer) {
  BoardConfig config = small_board(kWindow7);
  config.allocation.left_image = {"bank0"};
  config.allocation.right_image = {"bank2"};
  run(config, 16);
  EXPECT_NEAR(fps() / camera_fps(), 1.0 / 3, kOnePercent / 3);
}

}  // namespace
}  // namespace stereotlm
