#include "tests/support/plain_cycle_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "tests/unit/support/worked_boards.h"

namespace stereotlm::test {
namespace {

// One row of four pixels, n = 3, D = 1, no filter, no tables, a bank for each buffer. By hand: of the twelve
// slots (k = 0..2 is row -1, 0, 1) numbers 1, 4, 7, 10 are not empty. Slot s is taken in cycle s and consumed
// in s + 2, the last in 13. The drain is one column, cycles 14..16, and completes the only word, which is
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

// left_image, right_image and disparity in one bank.
PlainCycleInput tiny_board_of_one_bank() {
  PlainCycleInput input = tiny_board();
  input.right_image = {0};
  input.disparity = {0};
  return input;
}

using FrameCycles = std::vector<std::uint64_t>;

void expect_states(const PlainPortStates& states, const PlainPortStates& expected) {
  EXPECT_EQ(states.granted, expected.granted);
  EXPECT_EQ(states.stalled, expected.stalled);
  EXPECT_EQ(states.passed, expected.passed);
  EXPECT_EQ(states.idle, expected.idle);
  EXPECT_EQ(states.blocked, expected.blocked);
  EXPECT_EQ(states.starved, expected.starved);
}

struct Trace {
  const char* name;
  void (*change)(PlainCycleInput&);  // of tiny_board()
  FrameCycles frame_cycles;
  friend void PrintTo(const Trace& trace, std::ostream* out) { *out << trace.name; }
};

class PlainCycleLoopTrace : public testing::TestWithParam<Trace> {};

TEST_P(PlainCycleLoopTrace, TakesTheCyclesTracedByHand) {
  PlainCycleInput input = tiny_board();
  GetParam().change(input);
  const FrameCycles& expected = GetParam().frame_cycles;
  EXPECT_EQ(run_plain_cycle_loop(input, static_cast<int>(expected.size())).frame_cycles, expected);
}

void with_tables(PlainCycleInput& input) {
  input.left_lut = 3;
  input.right_lut = 4;
}

// Disparities in the left image's bank, which turns round: the last read is in cycle 10, the write in 17, the
// next frame's first read in its cycle 1.
void with_turnaround(PlainCycleInput& input, int cycles, int pipeline_latency_cycles = 0) {
  input.disparity = {0};
  input.banks[0] = {PlainBankKind::kSyncBurst, cycles};
  input.pipeline_latency_cycles = pipeline_latency_cycles;
}

INSTANTIATE_TEST_SUITE_P(
    Of, PlainCycleLoopTrace,
    testing::Values(
        Trace{"TheBoardItself", [](auto&) {}, {18, 18}},
        Trace{"PipelineLatency", [](auto& input) { input.pipeline_latency_cycles = 16; }, {34}},
        Trace{"PipelinedTables", with_tables, {20}},
        Trace{"OneFlowThroughTable",
              [](auto& input) {
                with_tables(input);
                input.banks[3].kind = PlainBankKind::kZbtFlowThrough;
              },
              {20}},
        Trace{"FlowThroughTables",
              [](auto& input) {
                with_tables(input);
                input.banks[3].kind = input.banks[4].kind = PlainBankKind::kZbtFlowThrough;
              },
              {19}},
        Trace{"OneSlotInALane",  // taken every third cycle, the last in 33
              [](auto& input) { input.lane_fifo_slots = 1; },
              {40}},
        Trace{"TwoSlotsInALane",  // two in three cycles, the last in 16
              [](auto& input) { input.lane_fifo_slots = 2; },
              {23}},
        Trace{"ThreeSlotsInALane", [](auto& input) { input.lane_fifo_slots = 3; }, {18}},
        Trace{"RoomForTwoResults",
              [](auto& input) {
                input.width = 8;
                input.result_fifo_words = 2;
              },
              {30}},
        Trace{"RoomForOneResult",  // the first of the two words costs a cycle
              [](auto& input) {
                input.width = 8;
                input.result_fifo_words = 1;
              },
              {31}},
        Trace{"ThreeDisparities", [](auto& input) { input.disparities = 3; }, {24}},
        Trace{"ThreeDisparitiesWithLineBuffers",
              [](auto& input) {
                input.disparities = 3;
                input.fetch = PlainFetch::kLineBuffer;
              },
              {14}},
        Trace{
            "TwoPasses",  // each of the 12 slots and 9 consume-cycles of the drain takes 2 cycles, from 2 on
            [](auto& input) {
              input.disparities = 3;
              input.units = 2;
            },
            {45, 45}},
        Trace{"OnePassOfAllUnits",
              [](auto& input) {
                input.disparities = 3;
                input.units = 3;
              },
              {24}},
        Trace{"TwoPassesAndOneSlotInALane",  // taken every fourth cycle, the last in 44
              [](auto& input) {
                input.disparities = 2;
                input.units = 1;
                input.lane_fifo_slots = 1;
              },
              {61}},
        Trace{"TwoRowsOfWhichOneIsInTheImage",  // 16 slots, 4 cycles of drain
              [](auto& input) { input.rows = 2; },
              {23}},
        Trace{"TwoRows",
              [](auto& input) {
                input.height = 2;
                input.rows = 2;
              },
              {24}},
        Trace{"TwoRowsAndRoomForFourResults",  // two words enter in cycle 21, two in 37
              [](auto& input) {
                input.width = 8;
                input.height = input.rows = 2;
                input.result_fifo_words = 4;
              },
              {40}},
        Trace{"TwoRowsAndRoomForThreeResults",
              [](auto& input) {
                input.width = 8;
                input.height = input.rows = 2;
                input.result_fifo_words = 3;
              },
              {41}},
        Trace{"TwoRowsAndRoomForTwoResults",
              [](auto& input) {
                input.width = 8;
                input.height = input.rows = 2;
                input.result_fifo_words = 2;
              },
              {42}},
        Trace{"TwoRowsAndAFilterLargerThanTheWindow",  // w = 4, 3 strips, 4 columns of drain, all of 4 cycles
              [](auto& input) {
                input.filter_half = 3;
                input.cost_half = 1;
                input.rows = 2;
              },
              {71}},
        Trace{"JointTables",
              [](auto& input) {
                with_tables(input);
                input.right_lut = input.left_lut;
                input.joint_tables = true;
              },
              {20}},
        Trace{"WordCache", [](auto& input) { input.word_cache = true; }, {18}},
        Trace{"TurnaroundThatHasPassed", [](auto& input) { with_turnaround(input, 6); }, {18}},
        Trace{"Turnaround", [](auto& input) { with_turnaround(input, 7); }, {19}},
        Trace{"TurnaroundThatHasPassedByTheNextFrame",
              [](auto& input) { with_turnaround(input, 1); },
              {18, 18}},
        Trace{"TurnaroundOverTheNextFrame", [](auto& input) { with_turnaround(input, 2); }, {18, 19}},
        Trace{"TurnaroundThatHasPassedInThePipelineLatency",
              [](auto& input) { with_turnaround(input, 2, 1); },
              {19, 19}},
        Trace{
            "TurnaroundOverThePipelineLatency", [](auto& input) { with_turnaround(input, 3, 1); }, {19, 20}}),
    [](const auto& trace) { return trace.param.name; });

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

TEST(PlainCycleLoop, TakesASlotForBothLanesWithJointTables) {
  PlainCycleInput input = tiny_board();
  input.left_lut = input.right_lut = 3;
  input.joint_tables = true;
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  expect_states(result.port(PlainPort::kLeftLut), {4, 0, 8, 8, 0, 0});
  expect_states(result.port(PlainPort::kRightLut), {0, 0, 0, 20, 0, 0});
  expect_states(result.port(PlainPort::kRightPixel), {4, 0, 8, 8, 0, 0});
  EXPECT_EQ(result.banks[3].reads, 4U);
}

// The reads of left_pixel on a board whose table has the given entries, all in word 0 if they are valid.
std::uint64_t reads_with_cache(int height, PlainFetch fetch, const std::vector<bool>& valid) {
  PlainCycleInput input = tiny_board();
  with_tables(input);
  input.height = height;
  input.fetch = fetch;
  input.word_cache = true;
  input.left_table.emplace();
  for (const bool entry : valid) input.left_table->push_back(entry ? 0x8000'0002U : 0U);
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  EXPECT_EQ(result.port(PlainPort::kLeftPixel).granted + result.port(PlainPort::kLeftPixel).passed,
            fetch == PlainFetch::kColumn ? 12U * static_cast<unsigned>(height)
                                         : 4U * static_cast<unsigned>(height + 1));
  return result.banks[0].reads;
}

TEST(PlainCycleLoop, KeepsAWordForEachPlaceInAColumnUpToTheEndOfTheStrip) {
  EXPECT_EQ(reads_with_cache(1, PlainFetch::kColumn, std::vector<bool>(4, true)), 1U);
  // Rows 0 and 1 are at k = 1, 2 of the first strip, and at 0, 1 of the second.
  EXPECT_EQ(reads_with_cache(2, PlainFetch::kColumn, std::vector<bool>(8, true)), 4U);
}

TEST(PlainCycleLoop, KeepsOneWordUpToTheEndOfTheRowWithLineBuffers) {
  EXPECT_EQ(reads_with_cache(2, PlainFetch::kLineBuffer, std::vector<bool>(8, true)), 2U);
}

TEST(PlainCycleLoop, KeepsTheWordOverInvalidEntries) {
  EXPECT_EQ(reads_with_cache(1, PlainFetch::kColumn, {false, true, false, true}), 1U);
}

TEST(PlainCycleLoop, CachesOnASideWithoutTable) {
  PlainCycleInput input = tiny_board();
  input.width = 8;
  input.word_cache = true;
  expect_states(run_plain_cycle_loop(input, 1).port(PlainPort::kLeftPixel), {2, 0, 22, 6, 0, 0});
}

TEST(PlainCycleLoop, EndsTheRowsOfAStripOneAfterAnother) {
  PlainCycleInput input = tiny_board();
  input.height = 3;
  input.rows = 2;  // words are written in cycles 22 and 23, and in 38
  const PlainCycleResult result = run_plain_cycle_loop(input, 1);
  std::vector<std::uint64_t> ends;
  for (const PlainRowEnd& row : result.rows.at(0)) ends.push_back(row.cycles);
  EXPECT_EQ(ends, (std::vector<std::uint64_t>{23, 24, 39}));
}

class PlainCycleLoopWorkedValues : public testing::TestWithParam<WorkedBoard> {};

TEST_P(PlainCycleLoopWorkedValues, ComeOut) {
  EXPECT_EQ(run(GetParam()).frame_cycles, FrameCycles{GetParam().frame_cycles});
}

void all_in_one_bank(PlainCycleInput& board, const PlainBank& bank) {
  board.width = 64;
  board.disparities = 16;
  board.fetch = PlainFetch::kLineBuffer;
  board.arbitration = PlainArbitration::kRoundRobin;
  board.result_fifo_words = 1;
  board.banks = {bank};
  put_into(board, 0, 0);
}

INSTANTIATE_TEST_SUITE_P(
    OfSmallBoards, PlainCycleLoopWorkedValues,
    testing::Values(
        WorkedBoard{"TwoSyncBurstBanks",
                    [](auto& board) {
                      in_two_banks(board);
                      with_log7(board);
                      board.width = 64;
                      board.height = 46;
                      board.window = 5;
                      board.disparities = 16;
                      board.units = 6;
                      board.rows = 4;
                      board.lane_fifo_slots = 2;
                      board.result_fifo_words = 4;
                      board.arbitration = PlainArbitration::kAge;
                      board.priority = {PlainPort::kHost,    PlainPort::kLeftPixel, PlainPort::kRightPixel,
                                        PlainPort::kLeftLut, PlainPort::kRightLut,  PlainPort::kResult};
                      board.banks = {{PlainBankKind::kSyncBurst, 3}, {PlainBankKind::kSyncBurst, 2}};
                    },
                    26'488},
        WorkedBoard{"OneSyncBurstBank",
                    [](auto& board) {
                      all_in_one_bank(board, {PlainBankKind::kSyncBurst, 2});
                      board.height = 47;
                      board.window = 3;
                      board.lane_fifo_slots = 3;
                    },
                    15'838},
        WorkedBoard{"OneQdrBank",
                    [](auto& board) {
                      all_in_one_bank(board, {PlainBankKind::kQdr});
                      board.height = 49;
                      board.window = 5;
                      board.priority = {PlainPort::kHost,       PlainPort::kRightLut,  PlainPort::kLeftLut,
                                        PlainPort::kRightPixel, PlainPort::kLeftPixel, PlainPort::kResult};
                    },
                    12'744},
        WorkedBoard{"WordCacheWithOddTables",
                    [](auto& board) {
                      board.width = 8;
                      board.height = 48;
                      board.window = 5;
                      board.disparities = 16;
                      board.word_cache = true;
                      board.left_lut = 0;
                      std::vector<std::uint32_t> entries;
                      for (int y = 0; y < 48; ++y) {
                        for (int x = 0; x < 8; ++x) {
                          const int column = 8 * (x / 8) + x % 8 / 2;
                          const int row = 3 * (y / 3);
                          const bool valid = (3 * x + 5 * y) % 11 != 0;
                          entries.push_back(valid ? 0x8000'0000U | static_cast<std::uint32_t>(row) << 16U |
                                                        static_cast<std::uint32_t>(column)
                                                  : 0);
                        }
                      }
                      board.left_table = board.right_table = entries;
                    },
                    2'257}),
    [](const auto& board) { return board.param.name; });

// left_pixel reads in cycles 1, 4, 7 and 10, right_pixel, after a stall in 1, in 2, 5, 8 and 11. The host
// writes in every cycle.
TEST(PlainCycleLoop, GrantsAReadAndAWriteOfAQdrBankInOneCycle) {
  PlainCycleInput input = tiny_board_of_one_bank();
  input.banks[0].kind = PlainBankKind::kQdr;
  PlainCore core(input);
  core.start_frame(0);
  for (int cycle = 0; cycle < 18; ++cycle) EXPECT_TRUE(core.step(cycle, PlainHostRequest{0, true})) << cycle;
  const PlainCycleResult result = core.result();
  EXPECT_EQ(result.banks[0].reads, 8U);
  EXPECT_EQ(result.banks[0].writes, 18U);
  EXPECT_EQ(result.banks[0].busy, 18U);
  EXPECT_EQ(result.banks[0].idle, 0U);
  EXPECT_EQ(result.banks[0].contended, 1U);
  EXPECT_EQ(result.blamed(PlainPort::kRightPixel, 0, PlainPort::kLeftPixel), 1U);
  EXPECT_EQ(result.blame.size(), 1U);
}

TEST(PlainCycleLoop, KeepsARoundRobinPlaceForEachDirectionOfAQdrBank) {
  PlainCycleInput input = tiny_board_of_one_bank();
  input.banks[0].kind = PlainBankKind::kQdr;
  input.arbitration = PlainArbitration::kRoundRobin;
  // With one place for both, the host's writes between the reads would move it in front of left_pixel.
  input.priority = {PlainPort::kHost,   PlainPort::kLeftPixel, PlainPort::kRightPixel,
                    PlainPort::kResult, PlainPort::kRightLut,  PlainPort::kLeftLut};
  PlainCore core(input);
  for (int frame = 0; frame < 2; ++frame) {
    core.start_frame(frame);
    for (int cycle = 0; core.runs(); ++cycle)
      core.step(100 * frame + cycle, cycle == 0 ? std::optional(PlainHostRequest{0, true}) : std::nullopt);
  }
  EXPECT_EQ(core.result().blamed(PlainPort::kRightPixel, 0, PlainPort::kLeftPixel), 2U);
}

// Cycles in which the host's word is granted. The host asks in every cycle but `pause`, and is last in the
// list.
std::string host_grants_by_age(const PlainBank& bank, int cycles, int pause = -1) {
  PlainCycleInput input = tiny_board_of_one_bank();  // without host, each lane asks in cycles 1, 4, 7 and 10
  input.arbitration = PlainArbitration::kAge;
  std::rotate(input.priority.begin(), input.priority.begin() + 1, input.priority.end());
  input.banks[0] = bank;
  PlainCore core(input);
  core.start_frame(0);
  std::string grants;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const bool asks = cycle != pause;
    const bool granted = core.step(cycle, asks ? std::optional(PlainHostRequest{0, true}) : std::nullopt);
    grants += !asks ? '-' : granted ? '1' : '0';
  }
  return grants;
}

TEST(PlainCycleLoop, GrantsTheOldestRequestByAgeAndEqualAgesByTheList) {
  EXPECT_EQ(host_grants_by_age({}, 13), "1001010101010");
}

TEST(PlainCycleLoop, EndsAnAgeInACycleWithoutRequest) { EXPECT_EQ(host_grants_by_age({}, 6, 3), "100-01"); }

TEST(PlainCycleLoop, LetsAllRequestsGrowOlderWhileTheBankTurnsRound) {
  EXPECT_EQ(host_grants_by_age({PlainBankKind::kSyncBurst, 1}, 11), "10000100001");
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

}  // namespace
}  // namespace stereotlm::test
