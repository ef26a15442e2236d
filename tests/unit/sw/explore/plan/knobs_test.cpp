#include "sw/explore/plan/knobs.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/explore/store/store.h"

namespace stereotlm::explore {
namespace {

using platform::BoardConfig;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using Texts = std::vector<std::string>;

constexpr const char* kBufferPairs = "allocation.left_image, right_image";
constexpr const char* kKind = "ssram.banks.*.kind";
constexpr const char* kTurnaround = "ssram.banks.*.turnaround_cycles";
constexpr const char* kOwnFilter = "matcher.filter={kernel: [[0, 0, 0], [1, 0, -1], [0, 0, 0]], shift: 0}";

const Texts kJoint = {"fpga.tables=joint", "allocation.right_lut=bank6", "ssram.banks.bank6={words: 614400}"};

BoardConfig board_with(const Texts& sets) { return platform::load_board("fpl2003", sets); }

// A bank of fpl2003 that has turnaround.
std::string burst(const std::string& bank, int cycles) {
  return "ssram.banks." + bank + "={kind: sync_burst, turnaround_cycles: " + std::to_string(cycles) + "}";
}

std::vector<KnobStep> steps_of(const std::string& knob, const BoardConfig& board) {
  std::vector<KnobStep> found;
  for (const KnobStep& step : knob_steps(board, true, std::nullopt).possible) {
    if (step.knob == knob) found.push_back(step);
  }
  return found;
}

TEST(KnobSteps, GoFromTheValueOfTheBoardToItsValidNeighbours) {
  struct Case {
    std::string knob;
    Texts sets;
    std::string steps;
  };
  std::string pairs;
  for (const std::string left : {"bank4", "bank5", "bank2", "bank3"}) {
    for (const std::string right : {"bank4", "bank5", "bank0", "bank1"})
      pairs += "2 buffers -> 3 buffers, in " + left + " and " + right + "; ";
  }
  const Case cases[] = {
      {"fpga.lane_fifo_slots", {}, "16 -> 17; 16 -> 15; "},
      {"fpga.lane_fifo_slots", {"fpga.lane_fifo_slots=1"}, "1 -> 2; "},
      {"fpga.clock_mhz", {}, "40 -> 41; 40 -> 39; "},
      {"fpga.clock_mhz", {"bridge.local_clock_mhz=43"}, "40 -> 43; 40 -> 41; 40 -> 39; "},
      {"bridge.local_clock_mhz", {}, "40 -> 80; 40 -> 41; 40 -> 39; "},
      {"bridge.local_clock_mhz", {"bridge.local_clock_mhz=43"}, "43 -> 80; 43 -> 44; 43 -> 42; 43 -> 40; "},
      {"bridge.local_clock_mhz", {"bridge.local_clock_mhz=20"}, "20 -> 80; 20 -> 40; 20 -> 21; 20 -> 19; "},
      {"fpga.result_delay_cycles", {}, "0 -> 1; "},
      {"fpga.result_delay_cycles", {"fpga.result_delay_cycles=16"}, "16 -> 17; 16 -> 15; "},
      {"matcher.window", {}, "7 -> 9; 7 -> 5; "},
      {"capture.fifo_trigger_words", {"capture.fifo_words=32"}, "32 -> 31; "},
      {"pci.width_bits", {}, "32 -> 64; "},
      {"pci.width_bits", {"pci.width_bits=64"}, "64 -> 32; "},
      {"pci.load.burst_words", {}, ""},
      {"pci.load.burst_words", {"pci.load={burst_words: 8, interval_us: 10}"}, "8 -> 9; 8 -> 7; "},
      {"fpga.arbitration", {}, "fixed_priority -> round_robin; fixed_priority -> age; "},
      {"matcher.fetch", {}, "column -> line_buffer; "},
      {"matcher.fetch", {"matcher.rows=2"}, "column -> line_buffer, matcher.rows 1; "},
      {"matcher.fetch", {"matcher.fetch=line_buffer"}, "line_buffer -> column; "},
      {"matcher.rows", {}, "1 -> 2; "},
      {"matcher.rows", {"matcher.rows=4"}, "4 -> 5; 4 -> 3; "},
      {"matcher.rows", {"matcher.rows=8"}, "8 -> 7; "},  // the queue has 8 words
      {"matcher.rows", {"matcher.fetch=line_buffer"}, ""},
      {"matcher.units", {}, "all -> 40; "},
      {"matcher.units", {"matcher.disparities=3"}, "all -> 2; "},
      {"matcher.units", {"matcher.disparities=1"}, ""},
      {"matcher.units", {"matcher.units=40"}, "40 -> 27; 40 -> all; "},
      {"matcher.units", {"matcher.units=79"}, "79 -> 27; 79 -> all; "},
      {"matcher.units", {"matcher.units=27"}, "27 -> 40; 27 -> 20; 27 -> all; "},
      {"matcher.units", {"matcher.units=80"}, "80 -> 40; 80 -> all; "},
      {"matcher.units", {"matcher.units=2", "matcher.disparities=5"}, "2 -> 3; 2 -> 1; 2 -> all; "},
      {"matcher.units", {"matcher.units=1"}, "1 -> 2; 1 -> all; "},
      {"matcher.cost", {}, "sad -> ssd; sad -> zncc; sad -> {census: 5}; "},
      {"matcher.cost", {"matcher.cost=zncc"}, "zncc -> sad; zncc -> ssd; zncc -> {census: 5}; "},
      {"matcher.cost",
       {"matcher.cost={census: 5}"},
       "{census: 5} -> sad; {census: 5} -> ssd; {census: 5} -> zncc; {census: 5} -> {census: 7}; {census: 5} "
       "-> {census: 3}; "},
      {"matcher.cost",
       {"matcher.cost={census: 7}"},
       "{census: 7} -> sad; {census: 7} -> ssd; {census: 7} -> zncc; {census: 7} -> {census: 5}; "},
      {"fpga.tables", {}, "separate -> joint in bank6; separate -> joint in bank7; "},
      {"fpga.tables", {kJoint[1], kJoint[2]}, "separate -> joint in bank6; "},
      {"fpga.tables", {"allocation.left_lut=none"}, ""},
      {"fpga.tables", {"allocation.right_lut=none"}, ""},
      {"fpga.tables", kJoint, "joint -> separate, right_lut in bank7; "},
      {"fpga.pixel_cache", {}, "none -> word; "},
      {"fpga.pixel_cache", {"fpga.pixel_cache=word"}, "word -> none; "},
      {"matcher.filter", {}, "log7 -> none; "},
      {"matcher.filter", {"matcher.filter=none"}, "none -> log7; "},
      {"matcher.filter", {kOwnFilter}, "its own -> none; its own -> log7; "},
      {kKind, {}, "zbt_pipelined -> zbt_flow_through; zbt_pipelined -> sync_burst; zbt_pipelined -> qdr; "},
      {kKind,
       {burst("bank3", 5)},
       "different -> zbt_pipelined; different -> zbt_flow_through; different -> sync_burst; "
       "different -> qdr; "},
      {kTurnaround, {}, ""},
      {kTurnaround, {burst("bank3", 5)}, "5 -> 6; 5 -> 4; "},
      {kTurnaround, {burst("bank3", 1)}, "1 -> 2; "},
      {kTurnaround,
       {burst("bank3", 5), burst("bank4", 2)},
       "different -> one more each; different -> one less each; "},
      // Results make the fewest accesses. Banks with pictures of the same side come last.
      {kBufferPairs, {}, pairs + "2 buffers -> 1 buffer; "},
      {"allocation.disparity",
       {"allocation.disparity=bank4"},
       "1 buffer -> 2 buffers, in bank5; 1 buffer -> 2 buffers, in bank0; 1 buffer -> 2 buffers, in bank1; "
       "1 buffer -> 2 buffers, in bank2; "},
      {"a bank more", {}, ""},
      {"a bank more",
       {"allocation.disparity=[bank0, bank5]"},
       "left_image[0] in bank0 -> in bank4; disparity[0] in bank0 -> in bank4; "},
      {"a bank more",
       {"allocation.disparity=[bank0, bank5]", "ssram.banks.bank4={words: 76799}"},
       "left_image[0] in bank0 -> in a new bank; disparity[0] in bank0 -> in a new bank; "},
      {"a bank less",  // the other banks have no buffers
       {"allocation={left_image: bank0, right_image: bank0, disparity: bank0, left_lut: none, right_lut: "
        "none}"},
       ""}};
  for (const Case& one : cases) {
    std::string found;
    for (const KnobStep& step : steps_of(one.knob, board_with(one.sets)))
      found += step.from + " -> " + step.to + "; ";
    EXPECT_EQ(found, one.steps) << one.knob;
  }
}

TEST(KnobSteps, ChangeNothingButTheirKnob) {
  const std::string bursts = "ssram.default={words: 524288, kind: sync_burst, turnaround_cycles: 2}";
  const std::string shared = "allocation.disparity=[bank0, bank5]";
  Texts joint_without_room = kJoint;
  joint_without_room.emplace_back("ssram.banks.bank7={words: 307199}");
  struct Case {
    std::string knob;
    Texts sets;
    std::size_t number;
    Texts changed;
  };
  const std::vector<Case> cases = {
      {"fpga.lane_fifo_slots", {}, 0, {"fpga.lane_fifo_slots=17"}},
      {"fpga.priority",
       {},
       1,
       {"fpga.priority=[host, left_pixel, result, right_pixel, left_lut, right_lut]"}},
      {"fpga.tables", {kJoint[2]}, 0, kJoint},
      {"fpga.tables", {}, 1, {"fpga.tables=joint", "allocation.left_lut=bank7"}},
      {"fpga.tables", kJoint, 0, {kJoint[2]}},  // bank7 is the first without buffers
      {"fpga.tables",
       joint_without_room,
       0,
       {"allocation.right_lut=bank6", kJoint[2], joint_without_room[3]}},
      {"matcher.fetch", {"matcher.rows=2"}, 0, {"matcher.fetch=line_buffer"}},
      {"matcher.units", {}, 0, {"matcher.units=40"}},
      {"matcher.cost", {}, 2, {"matcher.cost={census: 5}"}},
      {kKind, {}, 1, {bursts}},
      {kKind, {burst("bank3", 5)}, 2, {bursts, burst("bank3", 5)}},
      {kTurnaround, {burst("bank3", 5), burst("bank4", 2)}, 0, {burst("bank3", 6), burst("bank4", 3)}},
      {kTurnaround, {burst("bank3", 5), burst("bank4", 2)}, 1, {burst("bank3", 4), burst("bank4", 1)}},
      {kBufferPairs,
       {},
       1,
       {"allocation.left_image=[bank0, bank1, bank4]", "allocation.right_image=[bank2, bank3, bank5]"}},
      {kBufferPairs, {}, 16, {"allocation.left_image=bank0", "allocation.right_image=bank2"}},
      {"a bank more", {shared, burst("bank0", 3)}, 1, {burst("bank0", 3)}},
      {"a bank more",
       {shared, burst("bank0", 3), "ssram.banks.bank4={words: 1}"},
       1,
       {burst("bank0", 3), burst("new_bank", 3), "ssram.banks.bank4={words: 1}",
        "allocation.disparity=[new_bank, bank5]"}},
      {"a bank less", {}, 11, {"allocation.left_image=[bank0, bank5]"}}};
  for (const auto& [knob, sets, number, changed] : cases)
    EXPECT_EQ(steps_of(knob, board_with(sets)).at(number).board, board_with(changed)) << knob;
}

TEST(KnobSteps, AreValidBoardsThatDifferAndAreMarkedByTheirEffect) {
  const BoardConfig board = board_with({"allocation.disparity=[bank0, bank5]"});
  // Five swaps of neighbours, and each of six ports first and last, less two that are such swaps and two that
  // change nothing.
  EXPECT_EQ(steps_of("fpga.priority", board).size(), 13U);
  EXPECT_EQ(steps_of("a bank less", board_with({})).size(), 8U * 7 - 2) << "no bank holds both tables";
  for (const KnobStep& step : knob_steps(board, true, std::nullopt).possible) {
    EXPECT_THAT(platform::problems(step.board), IsEmpty()) << step.knob;
    EXPECT_FALSE(step.board == board) << step.knob;
    const bool is_longer_list = step.to.find(" buffers, in ") != std::string::npos;
    const bool is_group = step.knob.find("a bank ") == 0 || step.knob == "fpga.tables";
    EXPECT_EQ(step.group, is_group ? step.knob : is_longer_list ? step.knob + " more" : "");
    const std::set<std::string> same = {"matcher.fetch", "matcher.rows", "matcher.units"};
    EXPECT_EQ(step.changes_disparities, step.knob.find("matcher.") == 0 && same.count(step.knob) == 0)
        << step.knob;
  }
}

// The sets of a step come last, and take the place of earlier ones of the same key.
TEST(KnobSteps, HaveTheSetsThatMakeTheirBoard) {
  const Texts shared = {"allocation.disparity=[bank0, bank5]", kOwnFilter,
                        "pci.load={burst_words: 8, interval_us: 10}"};
  const Texts bursts = {burst("bank3", 5), burst("bank4", 2), "fpga.clock_mhz=33.25", "matcher.units=40"};
  for (const Texts& sets : {shared, bursts}) {
    for (const KnobStep& step : knob_steps(board_with(sets), true, std::nullopt).possible) {
      Texts pasted;
      for (const std::string& set : sets) {
        const std::string key = set.substr(0, set.find('='));
        const auto is_same = [&](const std::string& other) {
          const std::string path = other.substr(0, other.find('='));
          return path == key || key.rfind(path + ".", 0) == 0;
        };
        if (std::none_of(step.sets.begin(), step.sets.end(), is_same)) pasted.push_back(set);
      }
      pasted.insert(pasted.end(), step.sets.begin(), step.sets.end());
      EXPECT_EQ(platform::to_yaml(board_with(pasted)), platform::to_yaml(step.board))
          << step.knob << ": " << step.from << " -> " << step.to;
    }
  }
}

TEST(KnobSteps, AreForbiddenWhereAnotherKeyForbidsThem) {
  const auto forbidden = [](const std::string& preset, const Texts& sets) {
    Texts texts;
    for (const KnobStep& step : knob_steps(platform::load_board(preset, sets), false, std::nullopt).forbidden)
      texts.push_back(fmt::format("{}: {} -> {}: {}", step.knob, step.from, step.to, step.reason));
    return texts;
  };
  EXPECT_THAT(forbidden("fpl2003", {}), IsEmpty()) << "a bank less is possible somewhere";
  // 0 rows, which no board has, are not listed.
  EXPECT_THAT(forbidden("fpl2003-line-buffer", {}),
              ElementsAre("fpga.lanes: 1 -> 2: fpga.lanes = 2: must be 1 where matcher.fetch is "
                          "line_buffer; with column it may be 1..16",
                          "matcher.rows: 1 -> 2: matcher.rows = 2: must be 1 where matcher.fetch is "
                          "line_buffer; with column it may be 1..16"));
  EXPECT_THAT(forbidden("fpl2003", {"fpga.lanes=7"}),
              ElementsAre("fpga.lanes: 7 -> 8: fpga.lanes = 8: at most 7, the slots of a column "
                          "(matcher.window + matcher.rows - 1)",
                          "matcher.window: 7 -> 5: fpga.lanes = 7: at most 5, the slots of a column "
                          "(matcher.window + matcher.rows - 1)"));
  const Texts all = forbidden("two-banks", {});
  ASSERT_EQ(all.size(), 2U) << "one of the two steps of a bank less";
  EXPECT_EQ(
      all[0],
      "fpga.tables: joint -> separate, right_lut in bank0: ssram.banks.bank0.words = 524288: 90112 words "
      "missing, its buffers (left_lut, right_lut) need 614400; set fpga.tables to joint, or give the bank "
      "more words, or one of the tables another bank");
  EXPECT_EQ(all[1].substr(0, 31), "a bank less: bank0 -> into bank");
}

TEST(KnobSteps, AreForbiddenWhereTheTablesCannotBeJoined) {
  const KnobSteps steps = knob_steps(board_with({kJoint[2]}), false, "too wide");
  ASSERT_EQ(steps.forbidden.size(), 1U) << "the first of the steps to either bank";
  EXPECT_EQ(steps.forbidden[0].knob, "fpga.tables");
  EXPECT_EQ(steps.forbidden[0].to, "joint in bank6");
  EXPECT_EQ(steps.forbidden[0].reason, "too wide");
  for (const KnobStep& step : steps.possible) EXPECT_FALSE(step.board.fpga.joint_tables) << step.knob;
}

TEST(KnobSteps, GiveNoBankANameThatDiffersFromAnotherOnlyInCase) {
  const BoardConfig shared = board_with({"ssram.banks={New_Bank: {}, b: {words: 1048576}}",
                                         "allocation={left_image: New_Bank, right_image: b, disparity: b, "
                                         "left_lut: b, right_lut: b}"});
  const std::vector<KnobStep> steps = steps_of("a bank more", shared);
  ASSERT_FALSE(steps.empty());
  for (const KnobStep& step : steps) {
    std::set<std::string> names;
    for (const platform::BankConfig& bank : step.board.banks)
      EXPECT_TRUE(names.insert(without_case(bank.name)).second) << bank.name;
  }
}

TEST(KnobSteps, OfTheBoardAloneDoNotChangeTheComputer) {
  std::set<std::string> knobs;
  for (const KnobStep& step : knob_steps(board_with({}), false, std::nullopt).possible)
    knobs.insert(step.knob);
  for (const char* const knob :
       {"pci.clock_mhz", "cameras.trigger", "capture.fifo_words", "bridge.posted_words", "image.width"})
    EXPECT_THAT(knobs, Not(Contains(knob)));
  EXPECT_THAT(knobs, Contains("fpga.clock_mhz"));
}

}  // namespace
}  // namespace stereotlm::explore
