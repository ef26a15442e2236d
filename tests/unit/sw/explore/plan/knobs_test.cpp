#include "sw/explore/plan/knobs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/explore/store/bank_names.h"

namespace stereotlm::explore {
namespace {

using platform::BoardConfig;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

BoardConfig board_with(const std::vector<std::string>& sets) { return platform::load_board("fpl2003", sets); }

std::vector<KnobStep> steps_of(const std::string& knob, const BoardConfig& board, bool camera = true) {
  std::vector<KnobStep> found;
  for (const KnobStep& step : knob_steps(board, camera)) {
    if (step.knob == knob) found.push_back(step);
  }
  return found;
}

// "from -> to" of each step.
std::vector<std::string> texts_of(const std::string& knob, const BoardConfig& board) {
  std::vector<std::string> texts;
  for (const KnobStep& step : steps_of(knob, board)) texts.push_back(step.from + " -> " + step.to);
  return texts;
}

TEST(KnobSteps, AreBoardsThatDiffer) {
  const BoardConfig board = board_with({});
  for (const KnobStep& step : knob_steps(board, true)) {
    EXPECT_THAT(platform::problems(step.board), IsEmpty()) << step.knob;
    EXPECT_FALSE(step.board == board) << step.knob;
  }
}

TEST(KnobSteps, MoveNumbersByOneAndTheWindowByTwo) {
  const BoardConfig board = board_with({});
  EXPECT_THAT(texts_of("fpga.lane_fifo_slots", board), ElementsAre("16 -> 17", "16 -> 15"));
  EXPECT_THAT(texts_of("fpga.clock_mhz", board), ElementsAre("40 -> 41", "40 -> 39"));
  EXPECT_THAT(texts_of("matcher.window", board), ElementsAre("7 -> 9", "7 -> 5"));
  const auto steps = steps_of("fpga.lane_fifo_slots", board);
  EXPECT_EQ(steps[0].board, board_with({"fpga.lane_fifo_slots=17"}));
  EXPECT_FALSE(steps[0].changes_disparities);
  EXPECT_TRUE(steps_of("matcher.window", board)[0].changes_disparities);
}

TEST(KnobSteps, StayInsideTheRules) {
  EXPECT_THAT(texts_of("fpga.lane_fifo_slots", board_with({"fpga.lane_fifo_slots=1"})),
              ElementsAre("1 -> 2"));
  EXPECT_THAT(texts_of("capture.fifo_trigger_words",
                       board_with({"capture.fifo_words=32", "capture.fifo_trigger_words=32"})),
              ElementsAre("32 -> 31"));
}

TEST(KnobSteps, TakeEveryOtherWord) {
  const BoardConfig board = board_with({});
  EXPECT_THAT(texts_of("fpga.arbitration", board), ElementsAre("fixed_priority -> round_robin"));
  EXPECT_THAT(texts_of("matcher.fetch", board), ElementsAre("column -> line_buffer"));
  EXPECT_THAT(texts_of("matcher.filter", board), ElementsAre("log7 -> none"));
  EXPECT_THAT(texts_of("matcher.filter", board_with({"matcher.filter=none"})), ElementsAre("none -> log7"));
  EXPECT_THAT(texts_of("matcher.filter", board_with({"matcher.filter={kernel: [[0, 0, 0], [1, 0, -1], [0, 0, "
                                                     "0]], shift: 0}"})),
              ElementsAre("its own -> none", "its own -> log7"));
}

TEST(KnobSteps, ExchangeNeighboursInThePriority) {
  const auto steps = steps_of("fpga.priority", board_with({}));
  ASSERT_EQ(steps.size(), 5U);
  EXPECT_EQ(steps[1].from, "result, left_pixel");
  EXPECT_EQ(steps[1].to, "left_pixel, result");
  EXPECT_EQ(steps[1].board,
            board_with({"fpga.priority=[host, left_pixel, result, right_pixel, left_lut, right_lut]"}));
}

TEST(KnobSteps, TurnAllBanksIntoAnotherKind) {
  const BoardConfig board = board_with({});
  EXPECT_THAT(texts_of("ssram.banks.*.kind", board),
              ElementsAre("zbt_pipelined -> zbt_flow_through", "zbt_pipelined -> sync_burst"));
  const BoardConfig burst = steps_of("ssram.banks.*.kind", board)[1].board;
  for (const auto& bank : burst.banks) {
    EXPECT_EQ(bank.kind, memory::BankKind::kSyncBurst);
    EXPECT_EQ(bank.turnaround_cycles, 2);
  }
  const BoardConfig mixed = board_with({"ssram.banks.bank3={kind: sync_burst, turnaround_cycles: 5}"});
  EXPECT_THAT(
      texts_of("ssram.banks.*.kind", mixed),
      ElementsAre("different -> zbt_pipelined", "different -> zbt_flow_through", "different -> sync_burst"));
  EXPECT_EQ(steps_of("ssram.banks.*.kind", mixed)[2].board.banks[3].turnaround_cycles, 5);
}

TEST(KnobSteps, TurnAllBanksRoundFasterAndSlower) {
  const char* const knob = "ssram.banks.*.turnaround_cycles";
  EXPECT_THAT(texts_of(knob, board_with({})), IsEmpty());
  const BoardConfig one = board_with({"ssram.banks.bank3={kind: sync_burst, turnaround_cycles: 5}"});
  EXPECT_THAT(texts_of(knob, one), ElementsAre("5 -> 6", "5 -> 4"));
  EXPECT_EQ(steps_of(knob, one)[0].board.banks[3].turnaround_cycles, 6);
  EXPECT_EQ(steps_of(knob, one)[0].board.banks[2].turnaround_cycles, 0);
  const BoardConfig least = board_with({"ssram.banks.bank3={kind: sync_burst, turnaround_cycles: 1}"});
  EXPECT_THAT(texts_of(knob, least), ElementsAre("1 -> 2"));
  const BoardConfig two = board_with({"ssram.banks.bank3={kind: sync_burst, turnaround_cycles: 5}",
                                      "ssram.banks.bank4={kind: sync_burst, turnaround_cycles: 2}"});
  EXPECT_THAT(texts_of(knob, two), ElementsAre("different -> one more each", "different -> one less each"));
  EXPECT_EQ(steps_of(knob, two)[1].board.banks[4].turnaround_cycles, 1);
}

TEST(KnobSteps, AddAndTakeAwayBuffers) {
  const BoardConfig board = board_with({"allocation.disparity=bank4"});
  EXPECT_THAT(texts_of("allocation.left_image, right_image", board),
              ElementsAre("2 buffers -> 3 buffers", "2 buffers -> 1 buffer"));
  const auto steps = steps_of("allocation.left_image, right_image", board);
  EXPECT_THAT(steps[0].board.allocation.left_image, ElementsAre("bank0", "bank1", "bank0"));
  EXPECT_THAT(steps[0].board.allocation.right_image, ElementsAre("bank2", "bank3", "bank2"));
  EXPECT_THAT(steps[1].board.allocation.right_image, ElementsAre("bank2"));
  EXPECT_THAT(texts_of("allocation.disparity", board), ElementsAre("1 buffer -> 2 buffers"));
}

TEST(KnobSteps, GiveABufferThatSharesItsBankANewOne) {
  EXPECT_THAT(texts_of("a bank more", board_with({})), IsEmpty());
  const BoardConfig shared = board_with(
      {"allocation.disparity=[bank0, bank5]", "ssram.banks.bank0={kind: sync_burst, turnaround_cycles: 3}"});
  EXPECT_THAT(texts_of("a bank more", shared), ElementsAre("left_image[0] in bank0 -> in one of its own",
                                                           "disparity[0] in bank0 -> in one of its own"));
  const KnobStep step = steps_of("a bank more", shared)[1];
  EXPECT_TRUE(step.only_best);
  ASSERT_EQ(step.board.banks.size(), 9U);
  EXPECT_EQ(step.board.banks[8].turnaround_cycles, 3);
  EXPECT_THAT(step.board.allocation.disparity, ElementsAre(step.board.banks[8].name, "bank5"));
}

TEST(KnobSteps, GiveNoBankANameThatDiffersFromAnotherOnlyInCase) {
  const BoardConfig shared =
      board_with({"ssram.banks={New_Bank: {}, b: {words: 1048576}}", "allocation.left_image=New_Bank",
                  "allocation.right_image=b", "allocation.disparity=b", "allocation.left_lut=b",
                  "allocation.right_lut=b"});
  const std::vector<KnobStep> steps = steps_of("a bank more", shared);
  ASSERT_FALSE(steps.empty());
  for (const KnobStep& step : steps) EXPECT_EQ(bank_names_problem(step.board), std::nullopt);
}

TEST(KnobSteps, MoveAllBuffersOfABankIntoAnother) {
  const auto steps = steps_of("a bank less", board_with({}));
  // Of 8 * 7 all but the two of one table into the bank of the other, which do not fit.
  EXPECT_EQ(steps.size(), 54U);
  std::set<std::string> taken;
  for (const KnobStep& step : steps) {
    EXPECT_TRUE(step.only_best);
    if (step.from == "bank1" && step.to == "into bank5") {
      EXPECT_THAT(step.board.allocation.left_image, ElementsAre("bank0", "bank5"));
    }
  }
}

TEST(KnobSteps, LeaveBanksWithoutBuffersAlone) {
  const BoardConfig board =
      board_with({"ssram.banks={a: {words: 1048576}, spare: {words: 1048576}}",
                  "allocation={left_image: a, right_image: a, disparity: a, left_lut: a, right_lut: none}"});
  EXPECT_THAT(texts_of("a bank less", board), IsEmpty());
}

TEST(KnobSteps, OfTheBoardAloneLeaveTheComputerAsItIs) {
  std::set<std::string> knobs;
  for (const KnobStep& step : knob_steps(board_with({}), false)) knobs.insert(step.knob);
  EXPECT_THAT(knobs, Not(Contains("pci.clock_mhz")));
  EXPECT_THAT(knobs, Not(Contains("cameras.trigger")));
  EXPECT_THAT(knobs, Not(Contains("capture.fifo_words")));
  EXPECT_THAT(knobs, Not(Contains("bridge.posted_words")));
  EXPECT_THAT(knobs, Contains("fpga.clock_mhz"));
  EXPECT_THAT(knobs, Not(Contains("image.width")));
}

TEST(KnobSteps, HaveThoseOfALoadIfThereIsOne) {
  EXPECT_THAT(texts_of("pci.load.burst_words", board_with({})), IsEmpty());
  const BoardConfig loaded = board_with({"pci.load={burst_words: 8, interval_us: 10}"});
  EXPECT_THAT(texts_of("pci.load.burst_words", loaded), UnorderedElementsAre("8 -> 9", "8 -> 7"));
}

TEST(BoardPoints, AreTheBoardsInTheirOrder) {
  const BoardPoints points({board_with({}), board_with({"matcher.window=5"})}, {true, 3, ""});
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points.point(1).board->matcher.window, 5);
  EXPECT_EQ(points.point(0).run.frames, 3U);
}

}  // namespace
}  // namespace stereotlm::explore
