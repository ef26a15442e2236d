#include "sw/explore/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "platform/board_yaml.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {
namespace {

using test::ScratchFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const ScratchFolder& folder() {
  static const ScratchFolder kFolder;
  return kFolder;
}

std::string plan_path() { return (folder().path() / "plan.yaml").string(); }

Plan plan_of(const std::string& text) {
  std::ofstream(plan_path()) << text;
  return Plan::load(plan_path());
}

// What a plan is refused with, without the path of its file.
std::vector<std::string> refusals(const std::string& text) {
  try {
    plan_of(text);
    return {};
  } catch (const platform::BoardError& error) {
    std::vector<std::string> lines;
    for (const platform::Diagnostic& diagnostic : error.diagnostics()) {
      std::string place = diagnostic.place;
      if (place.find(plan_path()) == 0) place.erase(0, plan_path().size());
      lines.push_back(place + ": " + diagnostic.text);
    }
    return lines;
  }
}

const std::string kBoard = "board: fpl2003\n";

TEST(Plan, MayBeOfAnotherBoardThanItNames) {
  std::ofstream(plan_path()) << kBoard;
  const Plan plan = Plan::load(plan_path(), "fpl2003-qvga");
  EXPECT_EQ(plan.board(), "fpl2003-qvga");
  EXPECT_EQ(plan.point(0).board, platform::load_board("fpl2003-qvga"));
  EXPECT_EQ(plan_of(kBoard).board(), "fpl2003");
}

TEST(Plan, NamesTheFileOfItsCalibration) {
  const Plan plan = plan_of(kBoard + "run: {calibration: rigs/mine.yaml}\n");
  EXPECT_EQ(plan.calibration(), "rigs/mine.yaml");
  EXPECT_EQ(plan.calibration_place(), plan_path() + ":2:20");
  EXPECT_EQ(plan_of(kBoard).calibration(), "");
}

TEST(Plan, WithACalibrationHasOtherPoints) {
  Plan plan = plan_of(kBoard);
  const Point before = plan.point(0);
  EXPECT_EQ(plan.use_calibration("5a", 640, 480), std::nullopt);
  const Point point = plan.point(0);
  EXPECT_EQ(point.run.calibration, "5a");
  EXPECT_EQ(point.values.back().path, kCalibrationPath);
  EXPECT_EQ(std::get<std::string>(point.values.back().value), "5a");
  EXPECT_NE(point.hash, before.hash);
  PointRun run;
  run.calibration = "5a";
  EXPECT_EQ(point.hash, make_point(0, *before.board, run).hash);
}

TEST(Plan, MakesPointsImpossibleThatTheTablesDoNotFit) {
  Plan plan = plan_of(kBoard +
                      "zip: [{image.width: [640, 320], image.height: [480, 240]}]\n"
                      "vary: {allocation.left_lut: [bank6, none]}\n");
  EXPECT_EQ(plan.use_calibration("5a", 640, 480), std::nullopt);
  const std::string size =
      "run.calibration: image size = 640x480: must be that of the board's images, 320x240";
  for (std::uint64_t number = 0; number < plan.size(); ++number) {
    const Point point = plan.point(number);
    // The axes of `vary` come before those of `zip`.
    const bool is_small = number % 2 == 1;
    const bool has_none = number / 2 == 1;
    EXPECT_EQ(point.reason, is_small   ? size
                            : has_none ? "run.calibration: goes with a board that has both tables; "
                                         "allocation.left_lut = none"
                                       : "");
    EXPECT_EQ(point.board.has_value(), point.reason.empty());
    EXPECT_EQ(point.run.calibration, "5a");
  }
}

TEST(Plan, SaysIfNoPointCanHaveTheTables) {
  const std::string size = "image size = 320x240: must be that of the board's images, 640x480";
  EXPECT_EQ(plan_of(kBoard).use_calibration("5a", 320, 240), size);
  EXPECT_EQ(plan_of(kBoard + "vary: {allocation.left_lut: [bank6, none]}\n").use_calibration("5a", 320, 240),
            size);
  const std::string without = "board: fpl2003-no-calibration\n";
  const std::string none = "goes with a board that has both tables; allocation.left_lut = none";
  EXPECT_EQ(plan_of(without).use_calibration("5a", 640, 480), none);
  EXPECT_EQ(plan_of(without + "vary: {allocation.left_lut: [bank6, none]}\n").use_calibration("5a", 640, 480),
            std::nullopt);
}

TEST(Plan, WithoutAnythingIsItsBoard) {
  const Plan plan = plan_of(kBoard);
  ASSERT_EQ(plan.size(), 1U);
  const Point point = plan.point(0);
  EXPECT_EQ(point.board, platform::load_board("fpl2003"));
  EXPECT_EQ(point.yaml, to_yaml(*point.board));
  EXPECT_FALSE(point.run.camera);
  EXPECT_EQ(point.run.frames, 2U) << "one turn of its lists";
}

TEST(Plan, TakesTheCrossProductTheLastKeyFastest) {
  const Plan plan = plan_of(kBoard +
                            "vary:\n  matcher.window: [3, 5]\n  matcher.disparities: [10, 20, 30]\n"
                            "zip:\n  - {image.width: [320, 640], image.height: [240, 480]}\n");
  ASSERT_EQ(plan.size(), 12U);
  EXPECT_THAT(plan.varied(),
              ElementsAre("matcher.window", "matcher.disparities", "image.width", "image.height"));
  for (int number = 0; number < 12; ++number) {
    const auto board = *plan.point(static_cast<std::uint64_t>(number)).board;
    EXPECT_EQ(board.matcher.window, number / 6 == 0 ? 3 : 5);
    EXPECT_EQ(board.matcher.disparities, 10 * (number / 2 % 3 + 1));
    EXPECT_EQ(board.image.width, number % 2 == 0 ? 320 : 640);
    EXPECT_EQ(board.image.height, number % 2 == 0 ? 240 : 480);
  }
}

TEST(Plan, SetsKeysOfAllPoints) {
  const Plan plan = plan_of(kBoard + "set: {matcher.filter: none, ssram.banks.spare: {words: 16}}\n" +
                            "vary: {matcher.window: [3]}\n");
  const auto board = *plan.point(0).board;
  EXPECT_FALSE(board.matcher.filter);
  EXPECT_EQ(board.banks.size(), 9U);
  EXPECT_EQ(board, platform::load_board("fpl2003", {"matcher.filter=none", "ssram.banks.spare={words: 16}",
                                                    "matcher.window=3"}));
}

TEST(Plan, CountsRangesExactly) {
  const Plan plan = plan_of(kBoard + "vary: {fpga.clock_mhz: {from: 39.9, to: 40.2, step: 0.1}}\n");
  ASSERT_EQ(plan.size(), 4U);
  std::vector<double> clocks;
  for (std::uint64_t i = 0; i < plan.size(); ++i) clocks.push_back(plan.point(i).board->fpga.clock_mhz);
  EXPECT_THAT(clocks, ElementsAre(39.9, 40.0, 40.1, 40.2));
}

TEST(Plan, VariesHowAPointIsRun) {
  const Plan plan = plan_of(kBoard + "vary:\n  run.source: [preloaded, camera]\n  run.frames: [3, 4]\n");
  ASSERT_EQ(plan.size(), 4U);
  EXPECT_FALSE(plan.point(1).run.camera);
  EXPECT_TRUE(plan.point(2).run.camera);
  EXPECT_EQ(plan.point(2).run.frames, 3U);
  EXPECT_EQ(plan.point(3).run.frames, 4U);
  std::set<std::string> hashes;
  for (std::uint64_t i = 0; i < 4; ++i) hashes.insert(plan.point(i).hash);
  EXPECT_EQ(hashes.size(), 4U);
}

TEST(Plan, RunsOneTurnOfTheListsOrThirteenFramesOfTheComputer) {
  const Plan plan = plan_of(kBoard +
                            "set: {allocation.disparity: [bank4, bank5, bank5]}\n"
                            "vary: {run.source: [preloaded, camera]}\n");
  EXPECT_EQ(plan.point(0).run.frames, 6U) << "pairs of images, three disparities";
  EXPECT_EQ(plan.point(1).run.frames, 13U);
}

TEST(Plan, HashesTheBoardAndNotHowItIsWritten) {
  const Plan plan = plan_of(kBoard + "vary: {allocation.left_lut: [bank6, [bank6], bank5]}\n");
  EXPECT_EQ(plan.point(0).hash, plan.point(1).hash);
  EXPECT_NE(plan.point(0).hash, plan.point(2).hash);
  EXPECT_EQ(plan_of(kBoard + "set: {matcher.window: 7}\n").point(0).hash, plan.point(0).hash);
}

TEST(Plan, SaysWhyACombinationIsImpossible) {
  const Plan plan = plan_of(kBoard +
                            "vary:\n  capture.fifo_words: [16, 32]\n  capture.fifo_trigger_words: [32]\n"
                            "  image.width: [640, 2048]\n");
  ASSERT_EQ(plan.size(), 4U);
  const Point wrong = plan.point(0);
  EXPECT_FALSE(wrong.board);
  EXPECT_EQ(wrong.reason, "capture.fifo_trigger_words = 32: 1..fifo_words, which is 16");
  EXPECT_TRUE(plan.point(2).board);
  EXPECT_THAT(plan.point(1).reason, HasSubstr("; "));
  EXPECT_THAT(plan.point(1).reason, HasSubstr("words missing"));
  const auto width = std::find_if(wrong.values.begin(), wrong.values.end(),
                                  [](const auto& value) { return value.path == "capture.fifo_words"; });
  ASSERT_NE(width, wrong.values.end());
  EXPECT_EQ(std::get<std::int64_t>(width->value), 16);
  EXPECT_NE(plan.point(0).hash, plan.point(1).hash);
  EXPECT_EQ(plan.point(0).hash, plan.point(0).hash);
}

TEST(Plan, SamplesItsPointsEachOnce) {
  const std::string text =
      kBoard + "vary: {matcher.disparities: {from: 1, to: 254, step: 1}}\nsample: {points: 50, seed: 3}\n";
  const Plan plan = plan_of(text);
  ASSERT_EQ(plan.size(), 50U);
  std::set<int> disparities;
  for (std::uint64_t i = 0; i < 50; ++i) disparities.insert(plan.point(i).board->matcher.disparities);
  EXPECT_EQ(disparities.size(), 50U);
  EXPECT_GT(*disparities.rbegin(), 200);
  EXPECT_EQ(plan_of(text).point(7).hash, plan.point(7).hash);
}

TEST(Plan, OfAMillionPointsTakesNoTimeToLoad) {
  const Plan plan = plan_of(kBoard +
                            "vary:\n  matcher.disparities: {from: 1, to: 250, step: 1}\n"
                            "  fpga.clock_mhz: {from: 1, to: 40.9, step: 0.1}\n"
                            "  matcher.window: [3, 5, 7, 9, 11, 13, 15, 17, 19, 21]\n");
  EXPECT_EQ(plan.size(), 250U * 400 * 10);
  EXPECT_EQ(plan.point(999'999).board->matcher.window, 21);
}

TEST(Plan, KeepsItsConditions) {
  const auto texts = [](const std::string& where) {
    std::vector<std::string> found;
    const Plan plan = plan_of(kBoard + "where: " + where + "\n");
    for (const Condition& condition : plan.conditions()) found.push_back(condition.text);
    return found;
  };
  EXPECT_THAT(texts("image.width > 4"), ElementsAre("image.width > 4"));
  EXPECT_THAT(texts("[image.width > 4, 'matcher.window = 7']"),
              ElementsAre("image.width > 4", "matcher.window = 7"));
}

TEST(PlanRefusals, AreForConditionsThatCannotBeComputed) {
  const std::string vary = kBoard + "vary: {matcher.window: [3, 5]}\n";
  const std::string points = ": the plan would have 2 points";
  EXPECT_THAT(refusals(vary + "where: [1, abs(-9223372036854775808) > 0, \"json('{bad')\"]\n"),
              ElementsAre(":3:12: where = abs(-9223372036854775808) > 0: integer overflow",
                          ":3:43: where = \"json('{bad')\": malformed JSON", points));
  EXPECT_THAT(
      refusals(vary + "where: board.name MATCH 'fpl*'\n"),
      ElementsAre(HasSubstr(":3:8: where = board.name MATCH 'fpl*': not an SQL expression over keys: "),
                  points));
  for (const std::string only : {"3", "5"}) {  // of the last point, or of the first
    EXPECT_THAT(refusals(vary + "where: iif(matcher.window = " + only + ", json('{bad'), 1)\n"),
                ElementsAre(HasSubstr(": malformed JSON"), points));
  }
}

TEST(PlanRefusals, NameThePlaceTheValueAndTheRule) {
  EXPECT_THAT(
      refusals("bord: fpl2003\n"),
      ElementsAre(":1:1: bord = fpl2003: unknown key; nearest: board; keys: board, run, set, vary, zip, "
                  "where or sample",
                  ":1:1: board: missing: a preset, or the path of a board file"));
  EXPECT_THAT(refusals("board: fpl2004\n").front(), HasSubstr("nearest: fpl2003"));
  EXPECT_THAT(refusals(kBoard + "vary: {matcher.windw: [3]}\n"),
              ElementsAre(":2:8: vary: matcher.windw: unknown key; nearest known key: matcher.window"));
  EXPECT_THAT(
      refusals(kBoard + "vary: {matcher.window: 3}\n"),
      ElementsAre(":2:24: vary: matcher.window = 3: a list of values, or a range such as {from: 16, to: "
                  "128, step: 16}"));
  EXPECT_THAT(refusals(kBoard + "run: {source: prelaoded, frames: 0}\n"),
              ElementsAre(HasSubstr(":2:15: run.source = prelaoded: preloaded"),
                          HasSubstr(":2:34: run.frames = 0: 1..")));
  EXPECT_THAT(refusals(kBoard + "where: image.widht > 3\n"),
              ElementsAre(HasSubstr(
                  ":2:8: where = image.widht > 3: not an SQL expression over keys: no such column")));
}

TEST(PlanRefusals, AreForEachValueThatNoOtherKeyCanMakeRight) {
  EXPECT_THAT(refusals(kBoard + "vary:\n  matcher.window: [3, 4, 5, 99]\n  capture.fifo_words: [16]\n"),
              ElementsAre(HasSubstr(":3:23: matcher.window = 4: "), HasSubstr(":3:29: matcher.window = 99: "),
                          ": the plan would have 4 points"));
  EXPECT_THAT(refusals(kBoard + "set: {matcher.window: 4}\n"),
              ElementsAre(HasSubstr(":2:23: matcher.window = 4: ")));
  EXPECT_THAT(
      refusals(kBoard + "vary: {ssram.banks: [{a: {}}, {b: {size: 3}}]}\n"),
      ElementsAre(HasSubstr("ssram.banks.b.size = 3: unknown key"), ": the plan would have 2 points"));
}

TEST(PlanRefusals, AreForBanksWhoseNamesDifferOnlyInCase) {
  const std::string rule = ": the names differ only in case: a database could not tell their columns apart";
  EXPECT_THAT(refusals(kBoard + "set: {ssram.banks.BANK3.words: 4}\n"),
              ElementsAre(":1:8: ssram.banks = BANK3, bank3" + rule));
  EXPECT_THAT(refusals(kBoard + "vary: {ssram.banks.Bank0.words: [1, 2]}\n"),
              ElementsAre(":2:8: ssram.banks = bank0, Bank0" + rule, ": the plan would have 2 points"));
  EXPECT_THAT(refusals(kBoard + "vary: {ssram.banks: [{one: {}}, {two: {}, One: {}}]}\n"),
              ElementsAre(":2:43: ssram.banks = one, One" + rule, ": the plan would have 2 points"));
}

TEST(Plan, NamesTheBanksOfAllItsPoints) {
  EXPECT_THAT(
      plan_of("board: fpl2003\nvary: {ssram.banks: [{one: {}}, {two: {}}], ssram.default.words: [1, 2]}\n")
          .banks(),
      ElementsAre("bank0", "bank1", "bank2", "bank3", "bank4", "bank5", "bank6", "bank7", "one", "two"));
}

TEST(PlanRefusals, AreForKeysGivenTwice) {
  EXPECT_THAT(refusals(kBoard + "set: {matcher.window: 3}\nvary: {matcher.window: [5]}\n"),
              ElementsAre(HasSubstr(":3:8: vary: matcher.window: given before, at 2:7")));
  EXPECT_THAT(
      refusals(kBoard + "set: {ssram.banks.bank0.words: 1048576}\nvary: {ssram.banks: [{bank0: {}}]}\n"),
      ElementsAre(HasSubstr(":3:8: vary: ssram.banks: overlaps ssram.banks.bank0.words, given at 2:7")));
  EXPECT_THAT(refusals(kBoard + "vary: {matcher.window: [5], matcher.window: [7]}\n").front(),
              HasSubstr("repeated key, first at 2:8"));
}

TEST(PlanRefusals, AreForRangesThatDoNotEnd) {
  for (const std::string range : {"{from: 1, to: 4, step: 2}", "{from: 4, to: 1, step: 1}",
                                  "{from: 1, to: 4, step: 0}", "{from: 1, to: 1000002, step: 1}"}) {
    EXPECT_THAT(refusals(kBoard + "vary: {matcher.disparities: " + range + "}\n").front(),
                HasSubstr("to must be from plus a number of steps, at most 1000000 values"))
        << range;
  }
  EXPECT_THAT(refusals(kBoard + "vary: {matcher.disparities: {from: x, to: 4, step: 1}}\n").front(),
              HasSubstr("vary: matcher.disparities.from = x: a decimal number of at most 15 digits"));
  EXPECT_THAT(refusals(kBoard + "vary: {matcher.disparities: {from: 1, to: 4}}\n").front(),
              HasSubstr("vary: matcher.disparities.step: missing: a decimal number"));
}

TEST(PlanRefusals, AreForRangesWhoseNumbersDoNotFit) {
  EXPECT_THAT(
      refusals(kBoard + "vary: {fpga.clock_mhz: {from: 1844677, to: 1844677, step: 0.0000000000001}}\n"),
      ElementsAre(":2:31: vary: fpga.clock_mhz.from = 1844677: at most 18 digits, with the 13 decimal places "
                  "that the range has"));
  EXPECT_THAT(refusals(kBoard + "vary: {fpga.clock_mhz: {from: 0, to: 100000, step: 0.0000000000001}}\n"),
              ElementsAre(HasSubstr(":2:38: vary: fpga.clock_mhz.to = 100000: at most 18 digits")));
  EXPECT_EQ(
      plan_of(kBoard + "vary: {fpga.clock_mhz: {from: 99.9999999999999, to: 100, step: 0.0000000000001}}\n")
          .size(),
      2U);
}

TEST(PlanRefusals, AreForCalibrationsThatAreNoFile) {
  for (const std::string file : {"[a.yaml]", "\"\"", "null"}) {
    EXPECT_THAT(refusals(kBoard + "run: {calibration: " + file + "}\n").front(),
                HasSubstr(": the file of a calibration, as written by stereotlm calibrate"))
        << file;
  }
  EXPECT_THAT(refusals(kBoard + "vary: {run.calibration: [a.yaml, b.yaml]}\n").front(),
              HasSubstr(":2:8: vary: run.calibration: goes with `run`: one for all points"));
}

TEST(PlanRefusals, AreForGroupsOfDifferentLengths) {
  EXPECT_THAT(refusals(kBoard + "zip:\n  - {image.width: [320, 640], image.height: [240]}\n").front(),
              HasSubstr("zip: image.height: 1 values; must be as many as image.width has, 2"));
}

TEST(PlanRefusals, AreForSamplesLargerThanThePlan) {
  EXPECT_THAT(refusals(kBoard + "vary: {matcher.window: [3, 5]}\nsample: {points: 3, seed: 1}\n"),
              ElementsAre(HasSubstr(":3:18: sample.points = 3: 1..2"), ": the plan would have 2 points"));
  EXPECT_THAT(refusals(kBoard + "sample: {points: 1}\n").front(), HasSubstr("sample.seed: missing: 0.."));
}

TEST(PlanRefusals, AreForFilesThatAreNone) {
  EXPECT_THROW(Plan::load((folder().path() / "none.yaml").string()), platform::BoardError);
  EXPECT_THAT(refusals("[1, 2]\n").front(),
              HasSubstr(":1:1: the plan = [1, 2]: a plan is a map of board, run"));
  EXPECT_THAT(refusals("board: [\n").front(), HasSubstr("not YAML"));
}

}  // namespace
}  // namespace stereotlm::explore
