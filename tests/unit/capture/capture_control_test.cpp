// The controls of a camera and its capture board, without the kernel. The tests of the modules cover what they
// compute. These show which steps they need.
#include "models/capture/capture_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "models/capture/camera_control.h"
#include "models/capture/capture_registers.h"

namespace stereotlm::capture {
namespace {

constexpr std::uint32_t kAddress = 0x1000;

class ListedPixels : public CameraSource {
 public:
  ListedPixels(int width, int height) : picture(width, height) {
    std::iota(picture.pixels.begin(), picture.pixels.end(), std::uint8_t{1});
  }
  const kernels::GrayImage& frame(std::uint64_t /*number*/, std::uint64_t /*begin_ps*/) override {
    return picture;
  }
  kernels::GrayImage picture;
};

// Grants each request in its first clock. The first word follows an address clock and `wait_clocks`.
class QuickSlot : public pci::PciSlot {
 public:
  void request(pci::PciMasterIf& master, std::uint64_t from_ps) override {
    requests_ps.push_back(from_ps);
    master_ = &master;
    clock_edge_ = clock_.edge_at_or_after(from_ps);
  }
  pci::BurstResult transferred(std::uint64_t /*now_ps*/) const override { return {}; }
  const Clock& clock() const override { return clock_; }

  std::uint64_t next_ps() const { return master_ == nullptr ? kNever : clock_.edge_ps(clock_edge_); }
  void run_burst() {
    pci::PciMasterIf& master = *master_;
    master_ = nullptr;
    const pci::PciBurst burst = master.begin_burst(clock_.edge_ps(clock_edge_));
    for (std::size_t i = 0; i < burst.words->size(); ++i) memory[burst.address + 4 * i] = (*burst.words)[i];
    const std::uint64_t first_clock = clock_edge_ + 1 + wait_clocks;
    end_ps = clock_.edge_ps(first_clock + burst.words->size());
    master.end_burst({pci::BurstEnd::kComplete, burst.words->size(), first_clock, end_ps});
  }

  std::uint64_t wait_clocks = 0;
  std::vector<std::uint64_t> requests_ps;
  std::map<std::uint64_t, std::uint32_t> memory;
  std::uint64_t end_ps = 0;  // of the last burst

 private:
  Clock clock_{33.333};
  pci::PciMasterIf* master_ = nullptr;
  std::uint64_t clock_edge_ = 0;
};

// One side, stepped in a loop. The pictures are 16 x 3 pixels.
class CaptureControlTest : public testing::Test {
 protected:
  explicit CaptureControlTest(const CaptureBoardConfig& config = {4, 2}) : board(config) {
    board.bind(slot, camera);
    board.bind_triggered(camera);
  }
  void arm(std::uint64_t now_ps, std::uint32_t strobes = registers::kControlArm) {
    board.write(now_ps, registers::kBufferAddress, kAddress);
    board.write(now_ps, registers::kControl, strobes);
  }
  // Runs everything up to `end_ps`.
  void run_to(std::uint64_t end_ps) {
    for (;;) {
      const std::uint64_t now_ps = std::min({camera.next_ps(), board.next_ps(), slot.next_ps()});
      if (now_ps > end_ps) return;
      if (camera.next_ps() == now_ps) {
        camera.step(now_ps);
      } else if (board.next_ps() == now_ps) {
        steps_ps.push_back(now_ps);
        board.step(now_ps);
      } else {
        slot.run_burst();
      }
    }
  }
  std::uint64_t pixel_ps(int column, int row) const { return camera.timing().pixel_ps(column, row); }

  CameraConfig camera_config{16, 3, 29.97, CameraTrigger::kFreeRunning};
  ListedPixels source{16, 3};
  QuickSlot slot;
  CaptureControl board;
  CameraControl camera{camera_config, source, board};
  std::vector<std::uint64_t> steps_ps;  // of the board
};

TEST_F(CaptureControlTest, TakesOneStepForACaptureWhoseLastWordIsWritten) {
  arm(0);
  run_to(camera.timing().frame_ps(1) - 1);
  EXPECT_EQ(steps_ps, std::vector<std::uint64_t>{1});
  EXPECT_EQ(board.next_ps(), kNever);
  EXPECT_EQ(camera.next_ps(), camera.timing().frame_ps(1));
  ASSERT_EQ(slot.memory.size(), 12U);
  for (const auto& [address, word] : slot.memory) {
    const auto pixel = static_cast<std::uint32_t>(address - kAddress + 1);
    EXPECT_EQ(word, pixel | (pixel + 1) << 8U | (pixel + 2) << 16U | (pixel + 3) << 24U);
  }
  EXPECT_TRUE(board.interrupt());
  EXPECT_EQ(board.last_capture()->end_ps, slot.end_ps);
}

TEST_F(CaptureControlTest, RequestsTheBusForTheNextLineWhenTheLastWordsOfALineHaveGone) {
  arm(0);
  run_to(pixel_ps(0, 1) - 1);
  const std::vector<std::uint64_t> requests_ps = {pixel_ps(7, 0), pixel_ps(15, 0), pixel_ps(7, 1)};
  EXPECT_EQ(slot.requests_ps, requests_ps);
}

class CaptureControlDrops : public CaptureControlTest {
 protected:
  CaptureControlDrops() : CaptureControlTest({1, 1}) { arm(0); }
};

// The FIFO has one place. Word 0 of a line leaves too late for word 1, and the rest of the line is dropped.
TEST_F(CaptureControlDrops, TakesAStepAtTheLastPixelOfACaptureThatIsDropped) {
  slot.wait_clocks = slot.clock().edge_at_or_after(pixel_ps(1, 0));
  run_to(camera.timing().frame_ps(1) - 1);
  EXPECT_EQ(steps_ps, (std::vector<std::uint64_t>{1, pixel_ps(15, 2)}));
  EXPECT_EQ(slot.requests_ps, (std::vector<std::uint64_t>{pixel_ps(3, 0), pixel_ps(3, 1), pixel_ps(3, 2)}));
  EXPECT_EQ(board.last_capture()->end_ps, pixel_ps(15, 2));
  EXPECT_EQ(board.last_capture()->dropped_pixels, 3U * 12);
}

TEST_F(CaptureControlTest, TriggersItsCamerasWhichStepThenOnly) {
  CameraControl on_demand{{16, 3, 29.97, CameraTrigger::kOnDemand}, source, board};
  board.bind_triggered(on_demand);
  EXPECT_EQ(on_demand.next_ps(), kNever);
  arm(700, registers::kControlTrigger);
  EXPECT_EQ(on_demand.next_ps(), 700U);
  on_demand.step(700);
  EXPECT_EQ(on_demand.next_ps(), kNever);
  EXPECT_EQ(board.next_ps(), 701U);
  EXPECT_EQ(camera.stats().ignored_triggers, 1U);
}

class CaptureControlLevels : public CaptureControlTest, public FifoObserver {
 protected:
  CaptureControlLevels() { board.observe(static_cast<FifoObserver&>(*this)); }
  void word_came(std::uint64_t time_ps) override { came.push_back(time_ps); }
  void words_left(std::uint64_t time_ps, std::size_t words) override { left.emplace_back(time_ps, words); }
  std::vector<std::uint64_t> came;
  std::vector<std::pair<std::uint64_t, std::size_t>> left;
};

// The first burst begins as words 0 and 1 are complete, and ends with the first pixel of word 3.
TEST_F(CaptureControlLevels, HaveEachWordAsItComesAndAsItLeaves) {
  const Clock& clock = slot.clock();
  const std::uint64_t first = clock.edge_at_or_after(pixel_ps(7, 0));
  const std::uint64_t end = clock.edge_at_or_after(pixel_ps(12, 0));
  slot.wait_clocks = end - first - 3;  // address clock, wait clocks, two words
  arm(0);
  run_to(clock.edge_ps(end));
  EXPECT_EQ(came, (std::vector<std::uint64_t>{pixel_ps(3, 0), pixel_ps(7, 0), pixel_ps(11, 0)}));
  EXPECT_EQ(left, (std::vector<std::pair<std::uint64_t, std::size_t>>{{clock.edge_ps(end - 1), 1},
                                                                      {clock.edge_ps(end), 1}}));
  // Words that have come since are received when asked for, and not before.
  board.show_words(pixel_ps(15, 0) - 1);
  EXPECT_EQ(came.size(), 3);
  board.show_words(pixel_ps(15, 0));
  EXPECT_EQ(came.back(), pixel_ps(15, 0));
}

}  // namespace
}  // namespace stereotlm::capture
