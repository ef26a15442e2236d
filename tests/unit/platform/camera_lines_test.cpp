// The computer with lines of the cameras that are skipped, and the same computer without.
#include "platform/camera_lines.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/random_computer.h"
#include "tests/unit/platform/loop_run.h"

namespace stereotlm::platform {
namespace {

using Pair = std::array<std::uint32_t, 2>;  // [left, right]

using testing::aperture;
using testing::kCaptures;
using testing::Keys;
using testing::kFramePs;
using testing::LoopOutcome;

// What the program does: where the captures go, and which banks the core's frame uses beside each of them.
struct Program {
  Pair pages = {0U << 26U, 2U << 26U};               // of apertures 0 and 1
  std::optional<std::uint32_t> first_bank_of_frame;  // its five buffers are in this bank and the next four
  int captures = 2;
  std::uint64_t disturb_ps = 0;  // while a picture is captured, it disturbs the lines as often; 0: never
  fpga::Fidelity fidelity = fpga::Fidelity::kFast;
  std::optional<fpga::CycleWindow> window;  // that is traced
};

class LinesRun : public testing::LoopRun {
 public:
  LinesRun(const BoardConfig& board, const Program& program, std::uint64_t step_ps)
      : LoopRun(board, program.fidelity, step_ps), program_(program) {
    const std::array<std::uint32_t, 4> descriptor = {0x2000, 6U << 26U, 1U << 31U | 50U, 0};
    std::memcpy(memory.data() + kDescriptor, descriptor.data(), sizeof descriptor);
  }

  LoopOutcome outcome() {
    if (program_.window) trace(*program_.window);
    for (std::size_t side = 0; side < 2; ++side) {
      write(testing::page_register(side), program_.pages[side]);
      write(kCaptures[side] + capture::registers::kBufferAddress, kBuffers[side]);
    }
    for (int capture = 0; capture < program_.captures; ++capture) {
      if (program_.first_bank_of_frame) {
        run_for(kFramePs);  // the frame before ends
        start_frame(*program_.first_bank_of_frame);
      }
      arm_captures();
      const std::uint64_t end_ps =
          loop().now_ps() + static_cast<std::uint64_t>(2.1e12 / config.cameras.frame_rate_hz);
      for (std::uint64_t number = 0; program_.disturb_ps != 0 && loop().now_ps() < end_ps; ++number) {
        run_for(program_.disturb_ps);
        disturb(number);
      }
      if (loop().now_ps() < end_ps) run_for(end_ps - loop().now_ps());
      for (const std::uint64_t board : kCaptures) {
        note("status {}\n", read(board + capture::registers::kStatus));
        write(board + capture::registers::kStatus, capture::registers::kStatusDone);
      }
    }
    finish();
    const auto words = static_cast<std::size_t>(config.image.width * config.image.height / 4);
    if (program_.fidelity == fpga::Fidelity::kFast) {
      for (const std::uint32_t buffer : kBuffers) {
        access(false, buffer, testing::Words(words));  // refused if the bank does not exist
        note("words {}\n", fmt::join(done.words, ","));
      }
    }
    return {figures() + counters() + traced(), loop().skipped_lines()};
  }

 private:
  static constexpr std::uint32_t kDescriptor = 0x1000;
  static constexpr Pair kBuffers = {static_cast<std::uint32_t>(aperture(0)),
                                    static_cast<std::uint32_t>(aperture(1))};

  // While a picture is captured, the program accesses a register or a bank, or starts both DMA channels.
  void disturb(std::uint64_t number) {
    if (number % 3 == 0) {
      read(kCaptures[0] + capture::registers::kStatus);
    } else if (number % 3 == 1) {
      access(false, kBuffers[0], testing::Words(2));
    } else {
      for (std::uint64_t channel = 0; channel < pci::bridge::kChannels; ++channel)
        start_dma(channel, kDescriptor);
    }
  }

  const Program& program_;
};

BoardConfig board_of(const Keys& keys) { return testing::loop_board(297.3, keys); }

// The PCI bus moves the words of both pictures' lines, at most two in a clock. So it takes a line at least as
// long as it has words, in clocks.
std::uint64_t short_ps(const BoardConfig& board) {
  return static_cast<std::uint64_t>(board.image.width * 1e6 / (4 * board.pci.clock_mhz));
}

std::uint64_t skipped_lines(const BoardConfig& board, const Program& program = {}) {
  return testing::compare_with_steps<LinesRun>(board, program, short_ps(board)).skipped;
}

constexpr Program kFourPictures = [] {
  Program program;
  program.captures = 4;
  return program;
}();
constexpr std::uint64_t kLines = 4 * 48;

TEST(CameraLines, SkipsMostLinesOfUndisturbedPictures) {
  const BoardConfig board = board_of({});
  EXPECT_GT(skipped_lines(board, kFourPictures), kLines / 2);
  for (const int mhz : {20, 40, 66}) {  // with few phases against the local bus
    const BoardConfig few_phases = board_of({fmt::format("pci.clock_mhz={}", mhz)});
    EXPECT_GT(skipped_lines(few_phases, kFourPictures), kLines / 2) << mhz;
  }
  Program timing_only = kFourPictures;
  timing_only.fidelity = fpga::Fidelity::kTiming;
  EXPECT_GT(skipped_lines(board, timing_only), kLines / 2);
}

// Computers in which the lines fill the buses more or less, and lie differently against their clocks.
Keys random_keys(std::uint64_t seed) {
  test::SplitMix64 random(seed);
  const testing::RandomBuses buses = testing::random_buses(random);
  const int words = random.between(4, 40);
  const int wait = testing::one_of(random, {0, 1, 4, 4, 20});
  const int fifo = testing::one_of(random, {8, 16, 40, 140, 140, 4096});
  // From the time that the longer of both buses needs for a line at least, to several times as much.
  const double line_us = testing::decimal(random, 1, random.chance(50) ? 2 : 8) *
                         std::max(2 * (words + wait + 4) / buses.pci_mhz,
                                  2 * words * (1 + 3.0 / buses.burst_words) / buses.local_mhz);
  const int height = std::clamp(static_cast<int>(920 / line_us) + 1, random.between(12, 64), 300);
  Keys keys = buses.keys;
  keys.insert(keys.end(),
              {fmt::format("image={{width: {}, height: {}}}", 4 * words, height),
               fmt::format("cameras.frame_rate_hz={:.4f}", std::min(1e3, 1e6 / (line_us * height * 35 / 32))),
               fmt::format("cameras.trigger={}", random.chance(50) ? "free_running" : "on_demand"),
               fmt::format("capture.fifo_words={}", fifo),
               fmt::format("capture.fifo_trigger_words={}", random.between(1, std::min(fifo, 32))),
               fmt::format("pci.bridge_wait_clocks={}", wait),
               fmt::format("bridge.posted_words={}", testing::one_of(random, {3, 16, 64, 64, 4096}))});
  const Keys load = testing::random_load(random, 20, 400, 300);
  keys.insert(keys.end(), load.begin(), load.end());
  return keys;
}

TEST(CameraLines, GiveTheSameFiguresAsSteppedLines) {
  // Now and then a picture goes to the last bank, to one that does not exist, or over the end of a bank.
  constexpr std::uint32_t kLastBank = 7U << 26U;
  const Pair kPages[] = {{Program().pages[0], kLastBank},
                         {Program().pages[0], kLastBank + (1U << 26U)},
                         {131'072 - 600, Program().pages[1]},
                         {kLastBank, kLastBank + 60'000}};
  const std::uint64_t computers = test::random_computers(200);
  std::uint64_t lines = 0;
  std::uint64_t skipped = 0;
  for (std::uint64_t seed = 0; seed < computers; ++seed) {
    const BoardConfig board = load_board("fpl2003", random_keys(seed));
    Program program;
    if (seed % 8 == 0) program.first_bank_of_frame = 3;
    if (seed % 8 == 2) program.pages = kPages[seed / 8 % std::size(kPages)];
    if (seed % 4 == 1) program.disturb_ps = 17'000'000 + 1'234'567 * (seed % 100);
    lines += 2 * static_cast<std::uint64_t>(board.image.height);
    skipped += skipped_lines(board, program);
    ASSERT_FALSE(HasFailure()) << "seed " << seed;
  }
  if (computers >= 100) {  // fewer may all be of a kind of which no line is skipped
    EXPECT_GT(skipped, lines / 5);
  }
}

// 24 lines of each picture of 48 are skipped at least, beside a window of up to an eighth of the run.
TEST(CameraLines, GiveTheSameTraceAsSteppedLines) {
  test::SplitMix64 random(1);
  Program program = kFourPictures;
  for (int number = 0; number < 25; ++number) {
    program.fidelity = number % 2 == 0 ? fpga::Fidelity::kFast : fpga::Fidelity::kTiming;
    const BoardConfig board = board_of({fmt::format("pci.clock_mhz={}", testing::decimal(random, 25, 70))});
    program.window = testing::random_window(random, board, 4 * 2.1e12 / 297.3);
    EXPECT_GT(skipped_lines(board, program), kLines / 2) << number;
    ASSERT_FALSE(HasFailure()) << number;
  }
}

}  // namespace
}  // namespace stereotlm::platform
