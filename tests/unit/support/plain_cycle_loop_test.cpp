#include "tests/support/plain_cycle_loop.h"

#include <gtest/gtest.h>

#include <ostream>
#include <vector>

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

// left_pixel reads in cycles 1, 4, 7 and 10, right_pixel, after a stall in 1, in 2, 5, 8 and 11. The host writes
// in every cycle.
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

// Cycles in which the host's word is granted. The host asks in every cycle but `pause`, and is last in the list.
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
