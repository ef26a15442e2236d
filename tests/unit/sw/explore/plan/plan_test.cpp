#include "sw/explore/plan/plan.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "platform/config/board_yaml.h"
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

// The lines that a plan is refused with, without the path of its file.
std::vector<std::string> refusals(const std::string& text) {
  try {
    plan_of(text);
    return {};
  } catch (const platform::BoardError& error) {
    std::vector<std::string> lines;
    std::istringstream stream(error.what());
    for (std::string line; std::getline(stream, line);) {
      if (line.find(plan_path()) == 0) line.erase(0, plan_path().size());
      lines.push_back(line);
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

// Whether what is asked for in an impossible point is refused, as a file, for the same.
void expect_same_refusal(const Point& point) {
  ASSERT_FALSE(point.board);
  const std::string board = test::write_file(folder().path() / "asked_for.yaml", point.yaml);
  std::set<std::string> rules;
  try {
    platform::load_board(board);
  } catch (const platform::BoardError& error) {
    for (const auto& problem : error.diagnostics()) rules.insert(problem.text);
  }
  EXPECT_FALSE(rules.empty()) << point.yaml;
  std::string text = point.reason;
  for (const std::string& rule : rules) {
    const std::size_t at = text.find(rule);
    ASSERT_NE(at, std::string::npos) << rule << " is not in " << point.reason;
    text.erase(at, rule.size());
  }
  EXPECT_EQ(text.find_first_not_of("; "), std::string::npos) << text << " is not said of\n" << point.yaml;
}

TEST(Plan, KeepsTheBoardThatAnImpossiblePointAsksFor) {
  for (const std::string vary :
       {"capture.fifo_words: [16]", "image: [{width: 2048, height: 2048}]",
        "allocation.left_lut: [bank9, 'a, b: [']", "allocation.left_image: [bank0, [bank0, bank1, \"x y\"]]",
        "ssram.banks: [{a: {}, b: {words: 4}}]", "ssram.default.kind: [sync_burst]",
        "ssram.banks.bank3.kind: [sync_burst]", "ssram.default.turnaround_cycles: [3]",
        "ssram.banks.bank3: [{words: 1}]",
        "matcher: [{window: 5, disparities: 9, filter: none, fetch: column, lr_tolerance: off}], "
        "image.width: [2048]",
        "matcher.filter: [{kernel: [[-1, 0, 1], [0, 0, 0], [0, 0, 0]], shift: 2}], capture.fifo_words: "
        "[1]"}) {
    const Plan plan = plan_of(kBoard + "set: {name: 'yes: no'}\nvary: {" + vary + "}\n");
    expect_same_refusal(plan.point(plan.size() - 1));
  }
  const Plan plan = plan_of(kBoard + "vary: {image.width: [640, 2048], ssram.banks.spare.words: [9]}\n");
  const Point wide = plan.point(1);
  expect_same_refusal(wide);
  const auto value = [&wide](const std::string& path) {
    const auto found = std::find_if(wide.values.begin(), wide.values.end(),
                                    [&path](const platform::BoardValue& one) { return one.path == path; });
    return found == wide.values.end() ? -1 : std::get<std::int64_t>(found->value);
  };
  EXPECT_EQ(value("image.width"), 2048);
  EXPECT_EQ(value("ssram.banks.spare.words"), 9);
  EXPECT_THAT(wide.yaml, HasSubstr("\n  width: 2048\n"));
}

TEST(Plan, WithTablesThatDoNotFitKeepsItsBoard) {
  Plan plan = plan_of(kBoard + "zip: [{image.width: [640, 320], image.height: [480, 240]}]\n");
  plan.use_calibration("5a", 640, 480);
  EXPECT_EQ(plan.point(1).yaml,
            to_yaml(platform::load_board("fpl2003", {"image.width=320", "image.height=240"})));
}

TEST(Plan, MayHaveRangesOfAMillionAndAListThatFillsItsFile) {
  const std::string million = "{from: 1, to: 999.999, step: 0.001}";
  const Plan ranges =
      plan_of(fmt::format("{}vary: {{fpga.clock_mhz: {}, pci.clock_mhz: {}, bridge.local_clock_mhz: {}}}\n"
                          "sample: {{points: 3, seed: 1}}\n",
                          kBoard, million, million, million));
  EXPECT_EQ(ranges.size(), 3U);
  EXPECT_TRUE(ranges.point(2).board);
  std::string list;
  for (int i = 0; i < 250'000; ++i) list += "3,";
  EXPECT_EQ(plan_of(kBoard + "vary: {matcher.window: [" + list + "3]}\n").size(), 250'001U);
}

TEST(Plan, MayNameManyBanks) {
  std::string banks;
  for (int i = 0; i < 70'000; ++i) banks += fmt::format("{{b{}: {{}}}},", i);
  EXPECT_EQ(plan_of(kBoard + "vary: {ssram.banks: [" + banks + "]}\n").banks().size(), 70'008U);
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

TEST(PlanRefusals, AreNotForAValueThatAnotherKeyMakesRight) {
  const Plan kinds = plan_of(kBoard +
                             "zip:\n  - ssram.default.kind: [sync_burst, zbt_pipelined]\n"
                             "    ssram.banks.bank0.turnaround_cycles: [2, 1]\n"
                             "vary: {ssram.default.turnaround_cycles: [1, 3]}\n");
  ASSERT_EQ(kinds.size(), 4U);
  EXPECT_EQ(kinds.point(0).board->banks[0].turnaround_cycles, 2);
  EXPECT_EQ(kinds.point(2).board->banks[1].turnaround_cycles, 3);
  EXPECT_THAT(kinds.point(1).reason, HasSubstr("only where the kind is sync_burst"));
  const Plan load = plan_of(kBoard + "vary: {pci.load.burst_words: [1, 8], pci.load.interval_us: [10]}\n");
  EXPECT_EQ(load.point(1).board->pci.load->burst_words, 8);
  EXPECT_THAT(refusals(kBoard + "vary: {pci.load.burst_words: [1]}\n"),
              ElementsAre(HasSubstr(":2:31: pci.load.interval_us: missing: ")));
  EXPECT_THAT(
      refusals(kBoard + "vary: {pci.load: [none, {burst_words: 8}, {burst_words: 1, interval_us: 1}]}\n"),
      ElementsAre(HasSubstr("pci.load.interval_us: missing: "), ": the plan would have 3 points"));
  EXPECT_THAT(refusals(kBoard + "vary: {capture: [{fifo_words: 16, fifo_trigger_words: 32}]}\n").back(),
              HasSubstr("capture.fifo_trigger_words = 32: 1..fifo_words, which is 16"));
  EXPECT_THAT(refusals(kBoard + "vary: {matcher.filter.shift: [1, 2]}\n").front(),
              HasSubstr("matcher.filter is not a map here; set it as a whole"));
}

TEST(PlanRefusals, SayOnceHowManyValuesOfARangeAreRefused) {
  struct Case {
    std::string key;
    std::string range;
    std::string refusal;
  };
  const std::string window = "3..31, odd";
  const std::vector<Case> cases = {
      {"matcher.window", "{from: 1, to: 1000000, step: 1}",
       "999985 of 1000000 values refused, the first: matcher.window = 1: " + window},
      {"matcher.window", "{from: 3, to: 8, step: 1}",
       "3 of 6 values refused, the first: matcher.window = 4: " + window},
      {"matcher.window", "{from: 3, to: 5, step: 0.5}",
       "5 of 5 values refused, the first: matcher.window = 3.0: not an integer"},
      {"fpga.clock_mhz", "{from: 0.8, to: 1000.1, step: 0.1}",
       "3 of 9994 values refused, the first: fpga.clock_mhz = 0.8: 1..1000"},
      {"ssram.banks.bank0.words", "{from: 0, to: 999999, step: 1}",
       "1 of 1000000 values refused, the first: ssram.banks.bank0.words = 0: 1.."},
      {"matcher.lr_tolerance", "{from: -1, to: 253, step: 1}",
       "1 of 255 values refused, the first: matcher.lr_tolerance = -1: 0..253 or off"},
      {"run.frames", "{from: 0, to: 999999, step: 1}",
       "1 of 1000000 values refused, the first: run.frames = 0: 1..1000000, the frames"},
      {"matcher.fetch", "{from: 1, to: 3, step: 1}",
       "3 of 3 values refused, the first: matcher.fetch = 1: column or line_buffer"},
      {"matcher.filter.shift", "{from: 1, to: 3, step: 1}",
       "3 of 3 values refused, the first: matcher.filter.shift = 1: matcher.filter is not a map"},
      {"run.source", "{from: 1, to: 3, step: 1}",
       "3 of 3 values refused, the first: run.source = 1: preloaded"},
  };
  for (const Case& one : cases) {
    const auto lines = refusals(fmt::format("{}vary: {{{}: {}}}\n", kBoard, one.key, one.range));
    ASSERT_EQ(lines.size(), 2U) << one.key;
    EXPECT_THAT(lines[0], HasSubstr(fmt::format("vary: {} = {}: {}", one.key, one.range, one.refusal)));
    EXPECT_THAT(lines[1], HasSubstr(": the plan would have "));
  }
  EXPECT_EQ(plan_of(kBoard + "vary: {matcher.window: {from: 3, to: 31, step: 2}}\n").size(), 15U);
}

TEST(PlanRefusals, AreTwentyLinesAndTheNumberOfTheOthers) {
  std::string list = "1";
  for (int i = 1; i < 100; ++i) list += ", 1";
  const auto lines = refusals(kBoard + "vary: {matcher.window: [" + list + "]}\n");
  ASSERT_EQ(lines.size(), 22U);
  EXPECT_EQ(lines[19], ":2:82: matcher.window = 1: 3..31, odd");
  EXPECT_EQ(lines[20], "and 80 errors more");
  EXPECT_EQ(lines[21], ": the plan would have 100 points");
}

TEST(PlanRefusals, NameThePlaceOfAWrongBoard) {
  const std::string presets =
      ": not a preset, and not a path, which has a / or ends in .yaml; nearest: fpl2003; presets: ";
  EXPECT_THAT(refusals("run: {frames: 2}\nboard: fpl2004\n"),
              ElementsAre(HasSubstr(":2:8: board = fpl2004" + presets)));
  EXPECT_THAT(refusals("board: none.yaml\n"),
              ElementsAre(":1:8: board = none.yaml: cannot be read: No such file or directory"));
  EXPECT_THAT(refusals("board: \"\"\n").front(),
              HasSubstr(":1:8: board = \"\": a preset, or the path of a board file"));
  const std::string board =
      test::write_file(folder().path() / "board.yaml", "extends: fpl2003\nimage: {width: 5}\n");
  EXPECT_THAT(refusals("board: " + board + "\n"),
              ElementsAre(board + ":2:16: image.width = 5: 4..2048, a multiple of 4"));
  std::ofstream(plan_path()) << kBoard;
  EXPECT_THAT(test::message_of([] { Plan::load(plan_path(), "fpl2004"); }),
              HasSubstr("--board: board = fpl2004" + presets));
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
