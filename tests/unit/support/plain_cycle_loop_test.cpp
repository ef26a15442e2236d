#include "tests/support/plain_cycle_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/support/random_board.h"

namespace stereotlm::test {
namespace {

// One row of four pixels, n = 3, D = 1, no filter, no tables, a bank for each buffer, by hand: of the twelve
// slots (k = 0..2 is row -1, 0, 1) numbers 1, 4, 7, 10 are not empty. Slot s is taken in cycle s and consumed
// in s + 2, the last in 13; the drain is one column, cycles 14..16; with it the only word is complete, and
// written in cycle 17.
PlainCycleInput tiny_board() {
  PlainCycleInput input;
  input.width = 4;
  input.height = 1;
  input.window = 3;
  input.disparities = 1;
  input.pipeline_latency_cycles = 0;
  input.banks.resize(5);
  input.left_image = {0};
  input.right_image = {1};
  input.disparity = {2};
  return input;
}

PlainCycleInput tiny_board_with_tables() {
  PlainCycleInput input = tiny_board();
  input.left_lut = 3;
  input.right_lut = 4;
  return input;
}

// left_image, right_image and disparity in one bank.
PlainCycleInput tiny_board_of_one_bank() {
  PlainCycleInput input = tiny_board();
  input.right_image = {0};
  input.disparity = {0};
  return input;
}

using FrameCycles = std::vector<std::uint64_t>;

FrameCycles frame_cycles(const PlainCycleInput& input, int frames = 1) {
  return run_plain_cycle_loop(input, frames).frame_cycles;
}

void expect_states(const PlainPortStates& states, const PlainPortStates& expected) {
  EXPECT_EQ(states.granted, expected.granted);
  EXPECT_EQ(states.stalled, expected.stalled);
  EXPECT_EQ(states.passed, expected.passed);
  EXPECT_EQ(states.idle, expected.idle);
  EXPECT_EQ(states.blocked, expected.blocked);
  EXPECT_EQ(states.starved, expected.starved);
}

TEST(PlainCycleLoop, EndsAtTheCycleTracedByHand) {
  PlainCycleInput input = tiny_board();
  EXPECT_EQ(frame_cycles(input), FrameCycles{18});
  input.pipeline_latency_cycles = 16;
  EXPECT_EQ(frame_cycles(input), FrameCycles{34});
}

TEST(PlainCycleLoop, CountsThePortStatesTracedByHand) {
  PlainCycleInput input = tiny_board();
  input.pipeline_latency_cycles = 16;  // not counted
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  EXPECT_EQ(result.counted_cycles, 18U);
  expect_states(result.port(PlainPort::kLeftLut), {0, 0, 0, 18, 0, 0});
  expect_states(result.port(PlainPort::kLeftPixel), {4, 0, 8, 6, 0, 0});
  expect_states(result.port(PlainPort::kRightPixel), {4, 0, 8, 6, 0, 0});
  expect_states(result.port(PlainPort::kResult), {1, 0, 0, 17, 0, 0});
  expect_states(result.port(PlainPort::kHost), {0, 0, 0, 18, 0, 0});
  EXPECT_EQ(result.banks[0].reads, 4U);
  EXPECT_EQ(result.banks[0].idle, 14U);
  EXPECT_EQ(result.banks[2].writes, 1U);
  EXPECT_EQ(result.banks[2].idle, 17U);
}

TEST(PlainCycleLoop, LetsATableDelayByTheLatencyOfItsBank) {
  PlainCycleInput input = tiny_board_with_tables();
  EXPECT_EQ(frame_cycles(input), FrameCycles{20});
  input.banks[3].kind = PlainBankKind::kZbtFlowThrough;
  EXPECT_EQ(frame_cycles(input), FrameCycles{20});  // the right lane still takes as long
  input.banks[4].kind = PlainBankKind::kZbtFlowThrough;
  EXPECT_EQ(frame_cycles(input), FrameCycles{19});
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  expect_states(result.port(PlainPort::kLeftLut), {4, 0, 8, 7, 0, 0});
  expect_states(result.port(PlainPort::kLeftPixel), {4, 0, 8, 7, 0, 0});  // idle in cycle 0 and 13..18
}

TEST(PlainCycleLoop, UsesTheBankOfTheFrameAndItsLatency) {
  PlainCycleInput input = tiny_board();
  input.left_image = {0, 3};
  input.right_image = {1, 4};
  input.banks[3].kind = PlainBankKind::kZbtFlowThrough;
  input.banks[4].kind = PlainBankKind::kZbtFlowThrough;
  const PlainCycleResult result = run_plain_cycle_loop(input, 3);
  EXPECT_EQ(result.frame_cycles, (FrameCycles{18, 17, 18}));
  EXPECT_EQ(result.banks[0].reads, 8U);
  EXPECT_EQ(result.banks[3].reads, 4U);
}

TEST(PlainCycleLoop, PassesInvalidEntriesWithoutAccessInTheSameTime) {
  PlainCycleInput input = tiny_board_with_tables();
  input.left_table = std::vector<std::uint32_t>{0x8000'0000U, 0x0000'0001U, 0x8000'0002U, 0};
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  EXPECT_EQ(result.frame_cycles, FrameCycles{20});
  expect_states(result.port(PlainPort::kLeftLut), {4, 0, 8, 8, 0, 0});
  expect_states(result.port(PlainPort::kLeftPixel), {2, 0, 10, 8, 0, 0});
  expect_states(result.port(PlainPort::kRightPixel), {4, 0, 8, 8, 0, 0});
}

TEST(PlainCycleLoop, BlocksTheTakerWhileTheLaneIsFull) {
  PlainCycleInput input = tiny_board();
  input.lane_fifo_slots = 1;  // taken every third cycle, the last in 33
  EXPECT_EQ(frame_cycles(input), FrameCycles{40});
  expect_states(run_plain_cycle_loop(input, 1).port(PlainPort::kLeftPixel), {4, 0, 8, 6, 22, 0});
  input.lane_fifo_slots = 2;  // two in three cycles, the last in 16
  EXPECT_EQ(frame_cycles(input), FrameCycles{23});
  input.lane_fifo_slots = 3;  // every cycle
  EXPECT_EQ(frame_cycles(input), FrameCycles{18});
}

TEST(PlainCycleLoop, StarvesThePixelPortWhileTheTablePortIsBlocked) {
  PlainCycleInput input = tiny_board_with_tables();
  input.lane_fifo_slots = 1;  // taken every fifth cycle, handled two later
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  EXPECT_EQ(result.frame_cycles, FrameCycles{64});
  expect_states(result.port(PlainPort::kLeftLut), {4, 0, 8, 8, 44, 0});
  expect_states(result.port(PlainPort::kLeftPixel), {4, 0, 8, 8, 0, 44});
}

TEST(PlainCycleLoop, StarvesTheResultPortBetweenItsFirstAndLastWord) {
  PlainCycleInput input = tiny_board();
  input.width = 8;  // the two words are written in cycles 17 and 29
  expect_states(run_plain_cycle_loop(input, 1).port(PlainPort::kResult), {2, 0, 0, 17, 0, 11});
}

TEST(PlainCycleLoop, StopsTheMatcherWhileTheResultQueueIsFull) {
  PlainCycleInput input = tiny_board();
  input.width = 8;
  input.result_fifo_words = 2;
  EXPECT_EQ(frame_cycles(input), FrameCycles{30});
  input.result_fifo_words = 1;  // the first of the two words costs a cycle
  EXPECT_EQ(frame_cycles(input), FrameCycles{31});
}

TEST(PlainCycleLoop, DrainsWindowColumnsForEveryDisparity) {
  PlainCycleInput input = tiny_board();
  input.disparities = 3;
  EXPECT_EQ(frame_cycles(input), FrameCycles{24});
  input.fetch = PlainFetch::kLineBuffer;
  EXPECT_EQ(frame_cycles(input), FrameCycles{14});
}

TEST(PlainCycleLoop, FetchesEachRowOnceWithLineBuffers) {
  PlainCycleInput input = tiny_board();
  input.fetch = PlainFetch::kLineBuffer;
  EXPECT_EQ(plain_slot_count(input), 8U);  // rows 0 and 1
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  EXPECT_EQ(result.frame_cycles, FrameCycles{12});
  expect_states(result.port(PlainPort::kLeftPixel), {4, 0, 4, 4, 0, 0});
}

TEST(PlainCycleLoop, FetchesStripsAheadForAFilterLargerThanTheWindow) {
  PlainCycleInput input = tiny_board();
  input.filter_half = 1;  // h = r: no strip ahead
  EXPECT_EQ(plain_slot_count(input), 12U);
  input.filter_half = 3;  // w = 2; the only row is fetched in the first strip; the drain has 4 columns
  EXPECT_EQ(plain_slot_count(input), 36U);
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  EXPECT_EQ(result.frame_cycles, FrameCycles{51});
  expect_states(result.port(PlainPort::kLeftPixel), {4, 0, 32, 15, 0, 0});
}

TEST(PlainCycleLoop, GrantsTheOtherDirectionAtTurnaroundPlusOne) {
  PlainCycleInput input = tiny_board();
  input.disparity = {0};  // last read in cycle 10, the write asks in 17
  input.banks[0] = {PlainBankKind::kSyncBurst, 6};
  EXPECT_EQ(frame_cycles(input), FrameCycles{18});
  input.banks[0] = {PlainBankKind::kSyncBurst, 7};
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  EXPECT_EQ(result.frame_cycles, FrameCycles{19});
  EXPECT_EQ(result.blamed(PlainPort::kResult, 0, std::nullopt), 1U);
  EXPECT_EQ(result.blame.size(), 1U);
  EXPECT_EQ(result.banks[0].turnaround, 1U);
  EXPECT_EQ(result.banks[0].contended, 0U);
}

TEST(PlainCycleLoop, KeepsTheTurnaroundOverFramesInAbsoluteCycles) {
  PlainCycleInput input = tiny_board();
  input.disparity = {0};  // the write is in cycle 17, the next frame's first read asks in its cycle 1
  input.banks[0] = {PlainBankKind::kSyncBurst, 1};
  EXPECT_EQ(frame_cycles(input, 2), (FrameCycles{18, 18}));
  input.banks[0] = {PlainBankKind::kSyncBurst, 2};
  EXPECT_EQ(frame_cycles(input, 2), (FrameCycles{18, 19}));
  input.pipeline_latency_cycles = 1;  // these cycles pass for the bank too
  EXPECT_EQ(frame_cycles(input, 2), (FrameCycles{19, 19}));
  input.banks[0] = {PlainBankKind::kSyncBurst, 3};
  EXPECT_EQ(frame_cycles(input, 2), (FrameCycles{19, 20}));
}

TEST(PlainCycleLoop, GrantsTheFirstOfTheListWithFixedPriority) {
  PlainCycleInput input = tiny_board_of_one_bank();  // both lanes ask in cycle 1 and never together again
  PlainCycleResult result = run_plain_cycle_loop(input, 2);
  EXPECT_EQ(result.frame_cycles, (FrameCycles{19, 19}));
  EXPECT_EQ(result.blamed(PlainPort::kRightPixel, 0, PlainPort::kLeftPixel), 2U);
  EXPECT_EQ(result.blame.size(), 1U);
  EXPECT_EQ(result.banks[0].contended, 2U);

  std::swap(input.priority[2], input.priority[3]);
  result = run_plain_cycle_loop(input, 2);
  EXPECT_EQ(result.blamed(PlainPort::kLeftPixel, 0, PlainPort::kRightPixel), 2U);
  EXPECT_EQ(result.blame.size(), 1U);
}

// A list on which round robin starts with right_pixel, and after a result with left_pixel.
PlainCycleInput round_robin_board() {
  PlainCycleInput input = tiny_board_of_one_bank();
  input.arbitration = PlainArbitration::kRoundRobin;
  input.priority = {PlainPort::kRightPixel, PlainPort::kResult,   PlainPort::kLeftPixel,
                    PlainPort::kHost,       PlainPort::kRightLut, PlainPort::kLeftLut};
  return input;
}

TEST(PlainCycleLoop, KeepsTheRoundRobinPlaceOverFrames) {
  const PlainCycleResult result = run_plain_cycle_loop(round_robin_board(), 3);
  EXPECT_EQ(result.blamed(PlainPort::kLeftPixel, 0, PlainPort::kRightPixel), 1U);
  EXPECT_EQ(result.blamed(PlainPort::kRightPixel, 0, PlainPort::kLeftPixel), 2U);
  EXPECT_EQ(result.blame.size(), 2U);
}

TEST(PlainCycleLoop, DoesNotMoveTheRoundRobinPlaceWhileTheBankTurnsRound) {
  PlainCycleInput input = round_robin_board();
  input.banks[0] = {PlainBankKind::kSyncBurst,
                    2};  // frame 1: both refused in cycle 1, left_pixel granted in 2
  const PlainCycleResult result = run_plain_cycle_loop(input, 2);
  EXPECT_EQ(result.frame_cycles, (FrameCycles{19, 20}));
  EXPECT_EQ(result.blamed(PlainPort::kLeftPixel, 0, PlainPort::kRightPixel), 1U);
  EXPECT_EQ(result.blamed(PlainPort::kLeftPixel, 0, std::nullopt), 1U);
  EXPECT_EQ(result.blamed(PlainPort::kRightPixel, 0, std::nullopt), 1U);
  EXPECT_EQ(result.blamed(PlainPort::kRightPixel, 0, PlainPort::kLeftPixel), 1U);
  EXPECT_EQ(result.blame.size(), 4U);
  EXPECT_EQ(result.banks[0].turnaround, 1U);
  EXPECT_EQ(result.banks[0].contended, 3U);
}

TEST(PlainCycleLoop, ReportsAHangAtTheLimitAndNotBefore) {
  const PlainCycleInput input = tiny_board();
  const PlainCycleResult in_time = run_plain_cycle_loop(input, 2, 18);
  EXPECT_FALSE(in_time.hang);
  EXPECT_EQ(in_time.frame_cycles.size(), 2U);
  const PlainCycleResult too_late = run_plain_cycle_loop(input, 2, 17);
  EXPECT_TRUE(too_late.hang);
  EXPECT_TRUE(too_late.frame_cycles.empty());
}

std::uint64_t non_empty_slots(const PlainCycleInput& input) {
  if (input.fetch == PlainFetch::kLineBuffer) {
    return static_cast<std::uint64_t>(input.width) * static_cast<std::uint64_t>(input.height);
  }
  const int radius = (input.window - 1) / 2;
  std::uint64_t slots = 0;
  for (int v = -std::max(0, input.filter_half - radius); v < input.height; ++v) {
    for (int k = 0; k < input.window; ++k) {
      const int row = v + input.filter_half - radius + k;
      if (row >= 0 && row < input.height) slots += static_cast<std::uint64_t>(input.width);
    }
  }
  return slots;
}

TEST(PlainCycleLoop, KeepsEveryIdentityOnRandomBoards) {
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    const RandomBoard board = make_random_board(seed);
    SCOPED_TRACE(describe(board));
    const PlainCycleInput input = cycle_input(board);
    const PlainCycleResult result = run_plain_cycle_loop(input, board.frames);
    ASSERT_FALSE(result.hang);

    std::uint64_t total = 0;
    for (const std::uint64_t cycles : result.frame_cycles) total += cycles;
    const auto frames = static_cast<std::uint64_t>(board.frames);
    const std::uint64_t uncounted = frames * static_cast<std::uint64_t>(board.pipeline_latency_cycles);
    ASSERT_EQ(result.counted_cycles, total - uncounted);

    std::array<std::uint64_t, kPlainPortCount> blamed{};
    for (const auto& [key, cycles] : result.blame) blamed[static_cast<std::size_t>(key.port)] += cycles;
    std::uint64_t grants = 0;
    for (std::size_t port = 0; port < kPlainPortCount; ++port) {
      const PlainPortStates& s = result.ports[port];
      ASSERT_EQ(s.granted + s.stalled + s.passed + s.idle + s.blocked + s.starved, result.counted_cycles);
      ASSERT_EQ(s.stalled, blamed[port]);
      grants += s.granted;
    }
    std::uint64_t accesses = 0;
    std::uint64_t writes = 0;
    for (const PlainBankStates& bank : result.banks) {
      ASSERT_EQ(bank.busy + bank.turnaround + bank.idle, result.counted_cycles);
      ASSERT_EQ(bank.reads + bank.writes, bank.busy);
      accesses += bank.busy;
      writes += bank.writes;
    }
    ASSERT_EQ(grants, accesses);

    const std::uint64_t slots = frames * plain_slot_count(input);
    const std::uint64_t reads = frames * non_empty_slots(input);
    ASSERT_EQ(writes, frames * static_cast<std::uint64_t>(board.height) *
                          static_cast<std::uint64_t>(board.width / 4));
    ASSERT_EQ(result.port(PlainPort::kResult).granted, writes);
    for (const auto& [lut, pixel, bank] :
         {std::tuple(PlainPort::kLeftLut, PlainPort::kLeftPixel, board.left_lut),
          std::tuple(PlainPort::kRightLut, PlainPort::kRightPixel, board.right_lut)}) {
      ASSERT_EQ(result.port(pixel).granted + result.port(pixel).passed, slots);
      ASSERT_EQ(result.port(lut).granted, bank ? reads : 0);
      ASSERT_EQ(result.port(lut).passed, bank ? slots - reads : 0);
    }
  }
}

template <typename Change>
void expect_refused(Change change, const std::string& start_of_message) {
  PlainCycleInput input = tiny_board_with_tables();
  change(input);
  try {
    run_plain_cycle_loop(input, 1);
    ADD_FAILURE() << "accepted: " << start_of_message;
  } catch (const std::invalid_argument& refusal) {
    EXPECT_EQ(std::string(refusal.what()).rfind("plain cycle loop: " + start_of_message, 0), 0U)
        << refusal.what();
  }
}

TEST(PlainCycleLoop, RefusesInputThatIsNotSound) {
  expect_refused([](PlainCycleInput& input) { input.width = 6; }, "width = 6:");
  expect_refused([](PlainCycleInput& input) { input.height = 0; }, "height = 0:");
  expect_refused([](PlainCycleInput& input) { input.window = 4; }, "window = 4:");
  expect_refused([](PlainCycleInput& input) { input.disparities = 255; }, "disparities = 255:");
  expect_refused([](PlainCycleInput& input) { input.filter_half = 16; }, "filter_half = 16:");
  expect_refused([](PlainCycleInput& input) { input.lane_fifo_slots = 0; }, "lane_fifo_slots = 0:");
  expect_refused([](PlainCycleInput& input) { input.result_fifo_words = 65; }, "result_fifo_words = 65:");
  expect_refused([](PlainCycleInput& input) { input.pipeline_latency_cycles = -1; },
                 "pipeline_latency_cycles = -1:");
  expect_refused([](PlainCycleInput& input) { input.priority[0] = PlainPort::kResult; },
                 "priority: result named = 2:");
  expect_refused([](PlainCycleInput& input) { input.disparity = {}; }, "disparity length = 0:");
  expect_refused([](PlainCycleInput& input) { input.left_image = {5}; }, "left_image = 5:");
  expect_refused([](PlainCycleInput& input) { input.right_image = {1, 1}; }, "right_image length = 2:");
  expect_refused([](PlainCycleInput& input) { input.right_lut = -1; }, "right_lut = -1:");
  expect_refused([](PlainCycleInput& input) { input.left_table.emplace(3); }, "left_table length = 3:");
  expect_refused(
      [](PlainCycleInput& input) {
        input.left_lut.reset();
        input.left_table.emplace(4);
      },
      "left_table length = 4:");
  expect_refused(
      [](PlainCycleInput& input) {
        input.banks[4] = {PlainBankKind::kSyncBurst, 17};
      },
      "turnaround_cycles = 17:");
  EXPECT_THROW(run_plain_cycle_loop(tiny_board(), 0), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::test
