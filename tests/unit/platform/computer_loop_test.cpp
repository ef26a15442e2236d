// The event loop of the computer, without the kernel: the order of events of one time.
// Random computers compare its figures with the plain event loop.
#include "platform/loop/computer_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/capture/camera_timing.h"
#include "models/capture/capture_registers.h"
#include "models/fpga/register_map.h"
#include "models/kernels/gray_image.h"
#include "models/pci/bridge_registers.h"
#include "platform/config/computer_parts.h"
#include "tests/unit/platform/computer_registers.h"
#include "tests/unit/platform/preloaded_run.h"

namespace stereotlm::platform {
namespace {

namespace capture_map = capture::registers;
using testing::kCaptures;
using testing::kDevices;

using Words = std::vector<std::uint32_t>;

constexpr std::uint64_t kEdgePs = 25'000;  // a clock of PCI, of the local bus and of the core
constexpr std::uint64_t kFar = 1'000'000'000'000;

// All pictures are the same.
class GreySource : public capture::CameraSource {
 public:
  explicit GreySource(const BoardConfig& board) : picture_(board.image.width, board.image.height, 99) {}
  const kernels::GrayImage& frame(std::uint64_t /*number*/, std::uint64_t /*begin_ps*/) override {
    return picture_;
  }

 private:
  kernels::GrayImage picture_;
};

// A processor for ComputerLoop on the small board, with another clock of the PCI bus and faster cameras. Its
// bursts follow each other. The configuration may be changed before the first call of loop().
class LoopProcessor : public pci::PciMasterIf {
 public:
  struct Burst {
    bool write = false;
    std::uint64_t address = 0;
    Words words;
    std::size_t moved = 0;  // words
  };

  ComputerLoop& loop() {
    if (loop_ == nullptr) {
      picture_.emplace(config);
      loop_ = std::make_unique<ComputerLoop>(config, memory.data(), memory.size(), *picture_, *picture_,
                                             fpga::Fidelity::kFast);
    }
    return *loop_;
  }
  // To be called while the core runs no frame.
  ComputerCounters computer_counters() {
    return loop().controls().counters(loop().board().counters(loop().now_ps()), loop().now_ps());
  }

  pci::PciBurst begin_burst(std::uint64_t address_clock_ps) override {
    granted_ps.push_back(address_clock_ps);
    const Burst& burst = bursts.front();
    left_words_.assign(burst.words.begin() + static_cast<std::ptrdiff_t>(burst.moved), burst.words.end());
    return {burst.write, burst.address + 4 * burst.moved, &left_words_};
  }
  // A burst that was cut continues with its next word.
  void end_burst(const pci::BurstResult& result) override {
    results.push_back(result);
    Burst& burst = bursts.front();
    std::copy_n(left_words_.begin(), result.words,
                burst.words.begin() + static_cast<std::ptrdiff_t>(burst.moved));
    burst.moved += result.words;
    if (is_error(result.end) || burst.moved == burst.words.size()) {
      done = std::move(burst);
      bursts.pop_front();
    }
    if (bursts.empty()) {
      loop().notice();
    } else {
      request(result.end_ps);
    }
  }
  void request(std::uint64_t from_ps) { loop().host_slot().request(*this, from_ps); }
  // Runs one burst to its end.
  pci::BurstEnd access(bool write, std::uint64_t address, Words words) {
    bursts.push_back({write, address, std::move(words)});
    request(loop().now_ps());
    while (!bursts.empty()) loop().run(loop().now_ps() + kFar);
    return results.back().end;
  }
  void write(std::uint64_t address, std::uint32_t word) {
    EXPECT_EQ(access(true, address, {word}), pci::BurstEnd::kComplete);
  }
  std::uint32_t read(std::uint64_t address) {
    EXPECT_EQ(access(false, address, {0}), pci::BurstEnd::kComplete);
    return done.words.front();
  }
  // Arms both captures.
  void arm() {
    for (const std::uint32_t side : {0U, 1U}) {
      write(testing::page_register(1 + side), (side == 0 ? 1U : 3U) << 26U);
      write(kCaptures[side] + capture_map::kBufferAddress,
            static_cast<std::uint32_t>(testing::aperture(1 + side)));
      write(kCaptures[side] + capture_map::kControl, capture_map::kControlArm);
    }
  }
  // A frame whose end raises the interrupt. Its tables have no valid entry.
  void start_core() {
    write(kDevices.bridge_registers + pci::bridge::kInterruptEnable, pci::bridge::kDoorbell);
    std::uint32_t bank = 0;
    for (const std::uint64_t base : testing::kBaseRegisters)
      write(testing::core_register(base), fpga::registers::base(bank++, 0));
    write(testing::core_register(fpga::registers::kControl), fpga::registers::kControlStart);
  }

  BoardConfig config = [] {
    BoardConfig board = testing::small_board();
    board.pci.clock_mhz = 40;
    board.cameras.frame_rate_hz = 1000;
    return board;
  }();
  std::vector<unsigned char> memory = std::vector<unsigned char>(1U << 20U);
  std::deque<Burst> bursts;
  Burst done;  // the last one that has ended
  std::vector<std::uint64_t> granted_ps;
  std::vector<pci::BurstResult> results;

 private:
  std::optional<GreySource> picture_;
  std::unique_ptr<ComputerLoop> loop_;
  Words left_words_;  // of the burst
};

class ComputerLoopTest : public ::testing::Test, public LoopProcessor {};

// The load, which had the bus last, requests the clock that begins with the interrupt. A request of the
// processor at that time comes before the decision.
TEST_F(ComputerLoopTest, LetsTheProcessorTakePartInTheDecisionsOfTheTimeOfAnInterrupt) {
  LoopProcessor first;
  first.start_core();
  const std::uint64_t started_ps = first.loop().now_ps();
  first.loop().run(kFar);
  const std::uint64_t interrupt_ps = first.loop().now_ps();
  ASSERT_EQ(interrupt_ps % kEdgePs, 0U);

  const std::uint64_t interval_ps = 200 * kEdgePs;
  ASSERT_LT(started_ps + interval_ps, interrupt_ps);
  const auto us = [](std::uint64_t ps) { return static_cast<double>(ps) / 1e6; };
  config.pci.load = PciLoadConfig{4, us(interval_ps), us(interrupt_ps - interval_ps), 0};
  start_core();
  EXPECT_EQ(loop().now_ps(), started_ps);
  loop().run(kFar);
  EXPECT_EQ(loop().now_ps(), interrupt_ps);
  EXPECT_EQ(computer_counters().pci.masters[kTrafficGenerator].transactions, 1U);
  bursts.push_back({false, kDevices.host_memory, {0}});
  request(interrupt_ps);
  loop().run(kFar);
  EXPECT_EQ(granted_ps.back(), interrupt_ps);
}

// At this camera rate the last pixel of a frame arrives with a clock of the bus. In the last line the load
// keeps the bus until a word finds the one-word FIFO full: the rest is dropped, and the capture ends with the
// last pixel. A write at this time that clears `done` comes first, and clears nothing; 1 ns later it does.
class ComputerLoopPixels : public ComputerLoopTest, public ::testing::WithParamInterface<bool> {};

TEST_P(ComputerLoopPixels, ArriveAfterTheWritesOfTheirTime) {
  const bool later = GetParam();
  config.pci.clock_mhz = 1000;
  config.cameras.frame_rate_hz = 249.6;
  config.capture.fifo_words = 1;
  config.capture.fifo_trigger_words = 1;
  const capture::CameraTiming timing(camera_config(config));
  const std::uint64_t frame_ps = timing.frame_ps(1);
  const std::uint64_t last_ps = frame_ps + timing.last_pixel_ps();
  ASSERT_EQ(last_ps % 1000, 0U);
  const std::uint64_t hold_ps = frame_ps + timing.pixel_ps(1, 5);
  const std::uint64_t release_ps = frame_ps + timing.pixel_ps(9, 5);
  const auto us = [](std::uint64_t ps) { return static_cast<double>(ps) / 1e6; };
  config.pci.load = PciLoadConfig{1, 1e9, us(hold_ps), us(release_ps - hold_ps)};
  arm();
  loop().run(frame_ps + timing.pixel_ps(12, 5));
  EXPECT_FALSE(loop().interrupt());
  // The write: address clock, wait clocks, one word.
  const std::uint64_t write_ps = last_ps + (later ? 1000 : 0);
  const auto clocks = static_cast<std::uint64_t>(1 + config.pci.bridge_wait_clocks + 1);
  bursts.push_back({true, kDevices.left_capture + capture_map::kStatus, {capture_map::kStatusDone}});
  request(write_ps - 1000 * clocks);
  while (results.back().end_ps < write_ps) loop().run(kFar);
  EXPECT_EQ(results.back().end_ps, write_ps);
  EXPECT_EQ(read(kDevices.left_capture + capture_map::kDroppedPixels), 12U);
  EXPECT_EQ(read(kDevices.left_capture + capture_map::kStatus), later ? 0U : capture_map::kStatusDone);
}

INSTANTIATE_TEST_SUITE_P(ComputerLoop, ComputerLoopPixels, ::testing::Bool(), [](const auto& later) {
  return later.param ? "and_before_later_ones" : "with_them";
});

TEST_F(ComputerLoopTest, RefusesABoardWithProblems) {
  config.allocation.left_lut = "bank9";
  EXPECT_THROW(loop(), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::platform
