#include "sw/explore/plan/plan.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "platform/config/board_yaml.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Lines = std::vector<std::string>;

constexpr const char* kBoard = "board: fpl2003\n";

std::string file(const std::string& name) {
  static const test::ScratchFolder kFolder;
  return (kFolder.path() / name).string();
}

Plan load(const std::string& text, const std::string& board = "") {
  return Plan::load(test::write_file(file("plan.yaml"), text), board);
}

// A plan of the board fpl2003; `text` begins with its second line.
Plan plan_of(const std::string& text) { return load(kBoard + text); }

// The value of a key of a point, which is an integer; -1 if it has none.
std::int64_t value_of(const Point& point, const std::string& path) {
  const auto found = std::find_if(point.values.begin(), point.values.end(),
                                  [&path](const auto& value) { return value.path == path; });
  return found == point.values.end() ? -1 : std::get<std::int64_t>(found->value);
}

TEST(Plan, MayHaveAnotherBoardThanItNames) {
  const Plan plan = load(kBoard, "fpl2003-qvga");
  EXPECT_EQ(plan.board(), "fpl2003-qvga");
  EXPECT_EQ(plan.point(0).board, platform::load_board("fpl2003-qvga"));
  EXPECT_EQ(plan_of("").board(), "fpl2003");
  EXPECT_EQ(plan_of("").calibration(), "");
}

TEST(Plan, GivesAllPointsItsCalibration) {
  Plan plan = plan_of("run: {calibration: rigs/mine.yaml}\n");
  EXPECT_EQ(plan.calibration(), "rigs/mine.yaml");
  EXPECT_EQ(plan.calibration_place(), file("plan.yaml") + ":2:20");
  const Point before = plan.point(0);
  EXPECT_EQ(plan.use_calibration("5a", 640, 480, std::nullopt), std::nullopt);
  const Point point = plan.point(0);
  EXPECT_EQ(point.run.calibration, "5a");
  EXPECT_EQ(point.values.back().path, kCalibrationPath);
  EXPECT_EQ(std::get<std::string>(point.values.back().value), "5a");
  EXPECT_NE(point.hash, before.hash);
  EXPECT_EQ(point.hash, make_point(0, *before.board, {false, 0, "5a"}).hash);
}

TEST(Plan, MakesPointsImpossibleThatCannotHaveTheTables) {
  Plan plan = plan_of(
      "zip: [{image.width: [640, 320], image.height: [480, 240]}]\n"
      "vary: {allocation.left_lut: [bank6, none]}\n");
  EXPECT_EQ(plan.use_calibration("5a", 640, 480, std::nullopt), std::nullopt);
  const std::string size =
      "run.calibration: image size = 640x480: must be that of the board's images, 320x240";
  const std::string none = "run.calibration: needs a board with both tables, but allocation.left_lut = none";
  const Lines reasons = {"", size, none, size};  // the axes of `vary` come before those of `zip`
  ASSERT_EQ(plan.size(), reasons.size());
  for (std::uint64_t number = 0; number < plan.size(); ++number) {
    const Point point = plan.point(number);
    EXPECT_EQ(point.reason, reasons[number]);
    EXPECT_EQ(point.board.has_value(), point.reason.empty());
    EXPECT_EQ(point.run.calibration, "5a");
  }
  EXPECT_EQ(plan.point(1).yaml,
            to_yaml(platform::load_board("fpl2003", {"image.width=320", "image.height=240"})));
}

TEST(Plan, MakesPointsImpossibleWhoseJointTablesDoNotFit) {
  const std::string joint =
      "set: {allocation.right_lut: bank6, ssram.banks.bank6.words: 1048576}\n"
      "vary: {fpga.tables: [separate, joint]}\n";
  Plan plan = plan_of(joint);
  EXPECT_EQ(plan.use_calibration("5a", 640, 480, "too wide"), std::nullopt);
  EXPECT_EQ(plan.point(0).reason, "");
  EXPECT_EQ(plan.point(1).reason, "run.calibration: too wide");
  EXPECT_EQ(plan.use_calibration("5a", 640, 480, std::nullopt), std::nullopt);
  EXPECT_EQ(plan.point(1).reason, "");
  Plan all_joint = plan_of("set: {allocation.right_lut: bank6, fpga.tables: joint}\n");
  EXPECT_EQ(all_joint.use_calibration("5a", 640, 480, "too wide"), "too wide");
}

TEST(Plan, NamesTheRuleIfNoPointCanHaveTheTables) {
  const std::string size = "image size = 320x240: must be that of the board's images, 640x480";
  const std::string vary = "vary: {allocation.left_lut: [bank6, none]}\n";
  EXPECT_EQ(plan_of("").use_calibration("5a", 320, 240, std::nullopt), size);
  EXPECT_EQ(plan_of(vary).use_calibration("5a", 320, 240, std::nullopt), size);
  const std::string without = "board: fpl2003-no-calibration\n";
  EXPECT_EQ(load(without).use_calibration("5a", 640, 480, std::nullopt),
            "needs a board with both tables, but allocation.left_lut = none");
  EXPECT_EQ(load(without + vary).use_calibration("5a", 640, 480, std::nullopt), std::nullopt);
}

TEST(Plan, CombinesAllValuesTheLastKeyFastest) {
  const Plan plan = plan_of(
      "vary:\n  matcher.window: [3, 5]\n  matcher.disparities: [10, 20, 30]\n"
      "zip:\n  - {image.width: [320, 640], image.height: [240, 480]}\n");
  ASSERT_EQ(plan.size(), 12U);
  for (int number = 0; number < 12; ++number) {
    const auto board = *plan.point(static_cast<std::uint64_t>(number)).board;
    EXPECT_EQ(board.matcher.window, number / 6 == 0 ? 3 : 5);
    EXPECT_EQ(board.matcher.disparities, 10 * (number / 2 % 3 + 1));
    EXPECT_EQ(board.image.width, number % 2 == 0 ? 320 : 640);
    EXPECT_EQ(board.image.height, number % 2 == 0 ? 240 : 480);
  }
}

TEST(Plan, GivesItsPointsTheBoardWithTheirValues) {
  const std::string clocks = "vary: {fpga.clock_mhz: {from: 39.9, to: 40.2, step: 0.1}}\n";
  const std::string kinds =  // a turnaround needs the kind that another key gives
      "zip:\n  - ssram.default.kind: [sync_burst, zbt_pipelined]\n"
      "    ssram.banks.bank0.turnaround_cycles: [2, 1]\nvary: {ssram.default.turnaround_cycles: [1, 3]}\n";
  const std::string bursts = "ssram.default={words: 524288, kind: sync_burst, turnaround_cycles: ";
  struct Case {
    std::string plan;
    std::uint64_t size;
    std::uint64_t number;
    std::vector<std::string> sets;
  };
  const std::vector<Case> cases = {
      {"", 1, 0, {}},
      {"set: {matcher.filter: none, ssram.banks.spare: {words: 16}}\nvary: {matcher.window: [3]}\n",
       1,
       0,
       {"matcher.filter=none", "matcher.window=3", "ssram.banks.spare={words: 16}"}},
      {clocks, 4, 1, {"fpga.clock_mhz=40"}},
      {clocks, 4, 2, {"fpga.clock_mhz=40.1"}},
      {clocks, 4, 3, {"fpga.clock_mhz=40.2"}},
      {"vary: {fpga.clock_mhz: {from: 40.1, to: 39.6, step: -0.25}}\n", 3, 2, {"fpga.clock_mhz=39.6"}},
      {kinds, 4, 0, {bursts + "1}", "ssram.banks.bank0.turnaround_cycles=2"}},
      {kinds, 4, 2, {bursts + "3}", "ssram.banks.bank0.turnaround_cycles=2"}},
      {"vary: {pci.load.burst_words: [1, 8], pci.load.interval_us: [10]}\n",
       2,
       1,
       {"pci.load={burst_words: 8, interval_us: 10}"}}};
  for (const auto& [text, size, number, sets] : cases) {
    const Plan plan = plan_of(text);
    const Point point = plan.point(number);
    EXPECT_EQ(plan.size(), size) << text;
    EXPECT_EQ(point.board, platform::load_board("fpl2003", sets)) << text;
    EXPECT_EQ(point.yaml, to_yaml(*point.board));
  }
  EXPECT_THAT(plan_of(kinds).point(1).reason, HasSubstr("only where the kind is sync_burst"));
}

TEST(Plan, VariesKeysThatTakeWordsBesideNumbersOrMaps) {
  const Plan plan = plan_of(
      "vary:\n  matcher.units: [all, 40, 81]\n  matcher.cost: [sad, {census: 5}]\n"
      "where: matcher.cost = 'sad' OR matcher.units = 'all'\n");
  ASSERT_EQ(plan.size(), 6U);
  const auto text_of = [&plan](std::uint64_t number, const std::string& path) {
    for (const platform::BoardValue& value : plan.point(number).values) {
      if (value.path == path && std::holds_alternative<std::string>(value.value))
        return std::get<std::string>(value.value);
    }
    return std::string();
  };
  EXPECT_EQ(text_of(0, "matcher.units"), "all");
  EXPECT_EQ(text_of(0, "matcher.cost"), "sad");
  EXPECT_EQ(text_of(1, "matcher.cost"), "{census: 5}");
  EXPECT_EQ(value_of(plan.point(2), "matcher.units"), 40);
  EXPECT_EQ(plan.point(2).board->matcher.units, 40);
  EXPECT_THAT(plan.point(4).reason, HasSubstr("matcher.units = 81: 1..disparities, which is 80, or all"));
}

TEST(Plan, VariesTheRunOfItsPoints) {
  const Plan plan = plan_of("vary:\n  run.source: [preloaded, camera]\n  run.frames: [3, 4]\n");
  ASSERT_EQ(plan.size(), 4U);
  std::set<std::string> hashes;
  for (std::uint64_t i = 0; i < 4; ++i) {
    const Point point = plan.point(i);
    EXPECT_EQ(point.run.camera, i / 2 == 1);
    EXPECT_EQ(point.run.frames, i % 2 + 3);
    hashes.insert(point.hash);
  }
  EXPECT_EQ(hashes.size(), 4U);
}

TEST(Plan, RunsOneTurnOfTheListsAndWithCamerasTwelveFramesMore) {
  const Plan plan = plan_of(
      "set: {allocation.disparity: [bank4, bank5, bank5]}\nvary: {run.source: [preloaded, camera]}\n");
  EXPECT_EQ(plan.point(0).run.frames, 6U) << "two pairs of images, three disparities";
  EXPECT_EQ(plan.point(1).run.frames, 18U);
}

TEST(Plan, HashesTheBoardAndNotItsText) {
  const Plan plan = plan_of("vary: {allocation.left_lut: [bank6, [bank6], bank5]}\n");
  EXPECT_EQ(plan.point(0).hash, plan.point(1).hash);
  EXPECT_NE(plan.point(0).hash, plan.point(2).hash);
  EXPECT_EQ(plan_of("set: {matcher.window: 7}\n").point(0).hash, plan.point(0).hash);
}

TEST(Plan, GivesTheReasonWhyACombinationIsImpossible) {
  const Plan plan = plan_of(
      "vary:\n  capture.fifo_words: [16, 32]\n  capture.fifo_trigger_words: [32]\n"
      "  image.width: [640, 2048]\n");
  ASSERT_EQ(plan.size(), 4U);
  const Point wrong = plan.point(0);
  EXPECT_FALSE(wrong.board);
  EXPECT_EQ(wrong.reason, "capture.fifo_trigger_words = 32: 1..fifo_words, which is 16");
  EXPECT_EQ(value_of(wrong, "capture.fifo_words"), 16);
  EXPECT_TRUE(plan.point(2).board);
  EXPECT_THAT(plan.point(1).reason, HasSubstr("; "));
  EXPECT_THAT(plan.point(1).reason, HasSubstr("words missing"));
  EXPECT_NE(plan.point(1).hash, wrong.hash);
  EXPECT_EQ(plan.point(0).hash, wrong.hash);
}

TEST(Plan, MaySetWhatOnlyAVariedKeyMakesRight) {
  const Plan plan = plan_of("set: {image.width: 1280}\nvary: {ssram.default.words: [524288, 1048576]}\n");
  EXPECT_THAT(plan.point(0).reason, HasSubstr("90112 words missing"));
  EXPECT_TRUE(plan.point(1).board);
}

// Expects the board of an impossible point, read as a file, to be refused for the reason of the point.
void expect_same_refusal(const Point& point) {
  ASSERT_FALSE(point.board);
  std::set<std::string> rules;
  try {
    platform::load_board(test::write_file(file("asked_for.yaml"), point.yaml));
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
  EXPECT_EQ(text.find_first_not_of("; "), std::string::npos) << text << " is not a problem of\n"
                                                             << point.yaml;
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
        "matcher.filter: [{kernel: [[-1, 0, 1], [0, 0, 0], [0, 0, 0]], shift: 2}], capture.fifo_words: [1]",
        "ssram.banks.spare.words: [9], image.width: [640, 2048]"}) {
    const Plan plan = plan_of("set: {name: 'yes: no'}\nvary: {" + vary + "}\n");
    expect_same_refusal(plan.point(plan.size() - 1));
  }
  const Point wide = plan_of("vary: {ssram.banks.spare.words: [9], image.width: [2048]}\n").point(0);
  EXPECT_EQ(value_of(wide, "image.width"), 2048);
  EXPECT_EQ(value_of(wide, "ssram.banks.spare.words"), 9);
  EXPECT_THAT(wide.yaml, HasSubstr("\n  width: 2048\n"));
}

// Their points are not made when they are loaded.
TEST(Plan, MayBeLarge) {
  std::string listed;
  std::string banks;
  for (int i = 0; i < 100'000; ++i) listed += "3,";
  for (int i = 0; i < 30'000; ++i) banks += fmt::format("{{b{}: {{}}}},", i);
  EXPECT_EQ(plan_of("vary: {matcher.window: [" + listed + "3]}\n").size(), 100'001U);
  EXPECT_EQ(plan_of("vary: {ssram.banks: [" + banks + "]}\n").banks().size(), 30'008U);
  const std::string million = "{from: 1, to: 999.999, step: 0.001}";
  const Plan ranges =
      plan_of(fmt::format("vary: {{fpga.clock_mhz: {0}, pci.clock_mhz: {0}, bridge.local_clock_mhz: {0}}}\n"
                          "sample: {{points: 3, seed: 1}}\n",
                          million));
  EXPECT_EQ(ranges.size(), 3U);
  EXPECT_TRUE(ranges.point(2).board);
  const Plan points = plan_of(
      "vary:\n  matcher.disparities: {from: 1, to: 250, step: 1}\n"
      "  fpga.clock_mhz: {from: 1, to: 40.9, step: 0.1}\n"
      "  matcher.window: [3, 5, 7, 9, 11, 13, 15, 17, 19, 21]\n");
  EXPECT_EQ(points.size(), 250U * 400 * 10);
  EXPECT_EQ(points.point(999'999).board->matcher.window, 21);
}

TEST(Plan, SamplesItsPointsEachOnce) {
  const std::string text =
      "vary: {matcher.disparities: {from: 1, to: 254, step: 1}}\nsample: {points: 50, seed: 3}\n";
  const Plan plan = plan_of(text);
  ASSERT_EQ(plan.size(), 50U);
  std::set<int> disparities;
  for (std::uint64_t i = 0; i < 50; ++i) disparities.insert(plan.point(i).board->matcher.disparities);
  EXPECT_EQ(disparities.size(), 50U);
  EXPECT_GT(*disparities.rbegin(), 200);
  EXPECT_EQ(plan_of(text).point(7).hash, plan.point(7).hash);
}

TEST(Plan, NamesTheBanksOfAllItsPoints) {
  EXPECT_THAT(
      plan_of("vary: {ssram.banks: [{one: {}}, {two: {}}], ssram.default.words: [1, 2]}\n").banks(),
      ElementsAre("bank0", "bank1", "bank2", "bank3", "bank4", "bank5", "bank6", "bank7", "one", "two"));
}

// The lines with which a plan is refused, without the path of its file.
Lines refusal(const std::string& text) {
  Lines lines;
  try {
    load(text);
  } catch (const platform::BoardError& error) {
    std::istringstream stream(error.what());
    for (std::string line; std::getline(stream, line);) {
      if (line.find(file("plan.yaml")) == 0) line.erase(0, file("plan.yaml").size());
      lines.push_back(line);
    }
  }
  return lines;
}

// Pairs of a plan (without its first line, the board) and the texts expected in the lines of its refusal. A
// line that only counts the points need not be named.
using Refusals = std::vector<std::pair<std::string, Lines>>;

void expect_refusals(const Refusals& refusals) {
  for (const auto& [plan, texts] : refusals) {
    Lines lines = refusal(kBoard + plan);
    if (!lines.empty() && lines.back().find(": the plan would have ") == 0) lines.pop_back();
    ASSERT_EQ(lines.size(), texts.size()) << plan;
    for (std::size_t i = 0; i < lines.size(); ++i) EXPECT_THAT(lines[i], HasSubstr(texts[i])) << plan;
  }
}

TEST(PlanRefusals, NameThePlaceTheValueAndTheRule) {
  const std::string points = ": the plan would have 2 points";
  EXPECT_THAT(refusal("bord: fpl2003\n"),
              ElementsAre(":1:1: bord = fpl2003: unknown key; nearest: board; keys: board, run, set, vary, "
                          "zip, where, sample, placements, maximise, minimise or require",
                          ":1:1: board: missing: a preset, or the path of a board file"));
  EXPECT_THAT(refusal(std::string(kBoard) + "vary: {matcher.window: [3, 4]}\n"),
              ElementsAre(":2:28: matcher.window = 4: 3..31, odd", points));
  EXPECT_THAT(refusal("[1, 2]\n"),
              ElementsAre(HasSubstr(":1:1: the plan = [1, 2]: a plan is a map of board, run")));
  EXPECT_THAT(refusal("board: [\n"), ElementsAre(HasSubstr("not YAML")));
  EXPECT_THROW(Plan::load(file("none.yaml")), platform::BoardError);
  const std::string list = "a list of values, or a range such as {from: 16, to: 128, step: 16}";
  expect_refusals(
      {{"vary: {matcher.windw: [3]}\n",
        {":2:8: vary: matcher.windw: unknown key; nearest known key: matcher.window"}},
       {"vary: {matcher.window: 3}\n", {":2:24: vary: matcher.window = 3: " + list}},
       {"run: {source: prelaoded, frames: 0}\n",
        {":2:15: run.source = prelaoded: preloaded", ":2:34: run.frames = 0: 1.."}},
       {"zip:\n  - {image.width: [320, 640], image.height: [240]}\n",
        {"zip: image.height: 1 values; must be as many as image.width has, 2"}},
       {"vary: {matcher.window: [3, 5]}\nsample: {points: 3, seed: 1}\n", {":3:18: sample.points = 3: 1..2"}},
       {"vary: {matcher.window: [3, 5]}\nsample: {points: 2, seed: 9223372036854775808}\n",
        {"sample.seed = 9223372036854775808: 0..9223372036854775806"}},
       {"sample: {points: 1}\n", {"sample.seed: missing: 0.."}}});
}

TEST(PlanRefusals, NameThePlaceOfAWrongBoard) {
  const std::string presets =
      ": not a preset, and not a path, which has a / or ends in .yaml; nearest: fpl2003; presets: ";
  EXPECT_THAT(refusal("run: {frames: 2}\nboard: fpl2004\n"),
              ElementsAre(HasSubstr(":2:8: board = fpl2004" + presets)));
  EXPECT_THAT(refusal("board: none.yaml\n"),
              ElementsAre(":1:8: board = none.yaml: cannot be read: No such file or directory"));
  EXPECT_THAT(refusal("board: \"\"\n"),
              ElementsAre(HasSubstr(":1:8: board = \"\": a preset, or the path of a board file")));
  const std::string board = test::write_file(file("board.yaml"), "extends: fpl2003\nimage: {width: 5}\n");
  EXPECT_THAT(refusal("board: " + board + "\n"),
              ElementsAre(board + ":2:16: image.width = 5: 4..8192, a multiple of 4"));
  EXPECT_THAT(test::message_of([] { load(kBoard, "fpl2004"); }),
              HasSubstr("--board: board = fpl2004" + presets));
}

TEST(PlanRefusals, AreForConditionsThatCannotBeComputedOrAreNoExpressions) {
  const std::string vary = "vary: {matcher.window: [3, 5]}\nwhere: ";
  const std::string no_expression = "not an SQL expression over keys: ";
  expect_refusals(
      {{vary + "[1, abs(-9223372036854775808) > 0, \"json('{bad')\"]\n",
        {":3:12: where = abs(-9223372036854775808) > 0: integer overflow",
         ":3:43: where = \"json('{bad')\": malformed JSON"}},
       {vary + "board.name MATCH 'fpl*'\n", {":3:8: where = board.name MATCH 'fpl*': " + no_expression}},
       {vary + "image.widht > 3\n", {":3:8: where = image.widht > 3: " + no_expression + "no such column"}},
       {vary + "iif(matcher.window = 3, json('{bad'), 1)\n", {": malformed JSON"}},    // the first point
       {vary + "iif(matcher.window = 5, json('{bad'), 1)\n", {": malformed JSON"}}});  // the last point
}

TEST(PlanRefusals, AreForValuesThatNoOtherKeyMakesValid) {
  expect_refusals(
      {{"vary:\n  matcher.window: [3, 4, 5, 99]\n  capture.fifo_words: [16]\n",
        {":3:23: matcher.window = 4: ", ":3:29: matcher.window = 99: "}},
       {"set: {matcher.window: 4}\n", {":2:23: matcher.window = 4: "}},
       {"vary: {ssram.banks: [{a: {}}, {b: {size: 3}}]}\n", {"ssram.banks.b.size = 3: unknown key"}},
       {"vary: {pci.load.burst_words: [1]}\n", {":2:31: pci.load.interval_us: missing: "}},
       {"vary: {pci.load: [none, {burst_words: 8}, {burst_words: 1, interval_us: 1}]}\n",
        {"pci.load.interval_us: missing: "}},
       {"vary: {capture: [{fifo_words: 16, fifo_trigger_words: 32}]}\n",
        {"capture.destination: missing", "capture.host_frames: missing",
         "capture.fifo_trigger_words = 32: 1..fifo_words, which is 16"}},
       {"vary: {matcher.filter.shift: [1, 2]}\n",
        {"matcher.filter is not a map here; set it as a whole",
         "matcher.filter is not a map here; set it as a whole"}}});
}

TEST(PlanRefusals, CountTheRefusedValuesOfARangeAndNameOneThatDoesNotEnd) {
  struct Case {
    std::string key;
    std::string range;
    std::string refusal;
  };
  const std::string window = "3..31, odd";
  const std::string ends = "to must be from plus a number of steps, at most 1000000 values";
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
      {"matcher.units", "{from: 250, to: 256, step: 2}",
       "1 of 4 values refused, the first: matcher.units = 256: 1..254 or all"},
      {"run.frames", "{from: 0, to: 999999, step: 1}",
       "1 of 1000000 values refused, the first: run.frames = 0: 1..1000000, the frames"},
      {"matcher.fetch", "{from: 1, to: 3, step: 1}",
       "3 of 3 values refused, the first: matcher.fetch = 1: must be one of column or line_buffer"},
      {"matcher.filter.shift", "{from: 1, to: 3, step: 1}",
       "3 of 3 values refused, the first: matcher.filter.shift = 1: matcher.filter is not a map"},
      {"run.source", "{from: 1, to: 3, step: 1}",
       "3 of 3 values refused, the first: run.source = 1: preloaded"},
      {"matcher.disparities", "{from: 1, to: 4, step: 2}", ends},
      {"matcher.disparities", "{from: 4, to: 1, step: -2}", ends},
      {"matcher.disparities", "{from: 1, to: 1000002, step: 1}", ends}};
  for (const auto& [key, range, text] : cases) {
    expect_refusals({{fmt::format("vary: {{{}: {}}}\n", key, range),
                      {fmt::format("vary: {} = {}: {}", key, range, text)}}});
  }
  EXPECT_EQ(plan_of("vary: {matcher.window: {from: 3, to: 31, step: 2}}\n").size(), 15U);
  for (const auto& [range, rule] :
       {std::pair("{from: 4, to: 1, step: 1}", "step = 1: must be below 0: to is below from"),
        std::pair("{from: 4.5, to: 1, step: 0}", "step = 0: must be below 0: to is below from"),
        std::pair("{from: 1, to: 4, step: -1}", "step = -1: must be above 0: to is not below from"),
        std::pair("{from: 1, to: 1, step: 0}", "step = 0: must be above 0: to is not below from")}) {
    expect_refusals({{fmt::format("vary: {{matcher.disparities: {}}}\n", range),
                      {fmt::format("vary: matcher.disparities.{}", rule)}}});
  }
}

TEST(PlanRefusals, AreForRangesWhoseNumbersAreMissingOrHaveTooManyDigits) {
  const std::string tiny = ", step: 0.0000000000001}}\n";
  expect_refusals({{"vary: {matcher.disparities: {from: x, to: 4, step: 1}}\n",
                    {"vary: matcher.disparities.from = x: a decimal number of at most 15 digits"}},
                   {"vary: {matcher.disparities: {from: 1, to: 4}}\n",
                    {"vary: matcher.disparities.step: missing: a decimal number"}},
                   {"vary: {fpga.clock_mhz: {from: 1844677, to: 1844677" + tiny,
                    {":2:31: vary: fpga.clock_mhz.from = 1844677: at most 18 digits, with the 13 decimal "
                     "places that the range has"}},
                   {"vary: {fpga.clock_mhz: {from: 0, to: 100000" + tiny,
                    {":2:38: vary: fpga.clock_mhz.to = 100000: at most 18 digits"}}});
  EXPECT_EQ(plan_of("vary: {fpga.clock_mhz: {from: 99.9999999999999, to: 100" + tiny).size(), 2U);
}

TEST(PlanRefusals, CountTheErrorsBehindTwentyLinesAndThePoints) {
  std::string ones;
  for (int i = 0; i < 100; ++i) ones += "1, ";
  const auto lines = refusal(kBoard + ("vary: {matcher.window: [" + ones + "3]}\n"));
  ASSERT_EQ(lines.size(), 22U);
  EXPECT_EQ(lines[19], ":2:82: matcher.window = 1: 3..31, odd");
  EXPECT_EQ(lines[20], "and 80 errors more");
  EXPECT_EQ(lines[21], ": the plan would have 101 points");
}

TEST(PlanRefusals, AreForBanksWhoseNamesDifferOnlyInCase) {
  const std::string rule = ": the names differ only in case: a database could not distinguish their columns";
  expect_refusals(
      {{"set: {ssram.banks.BANK3.words: 4}\n", {":1:8: ssram.banks = BANK3, bank3" + rule}},
       {"vary: {ssram.banks.Bank0.words: [1, 2]}\n", {":2:8: ssram.banks = bank0, Bank0" + rule}},
       {"vary: {ssram.banks: [{one: {}}, {two: {}, One: {}}]}\n", {":2:43: ssram.banks = one, One" + rule}}});
}

TEST(PlanRefusals, AreForKeysGivenTwice) {
  expect_refusals({{"set: {matcher.window: 3}\nvary: {matcher.window: [5]}\n",
                    {":3:8: vary: matcher.window: given before, at 2:7"}},
                   {"set: {ssram.banks.bank0.words: 1048576}\nvary: {ssram.banks: [{bank0: {}}]}\n",
                    {":3:8: vary: ssram.banks: overlaps ssram.banks.bank0.words, given at 2:7"}},
                   {"vary: {matcher.window: [5], matcher.window: [7]}\n",
                    {"repeated key, first at 2:8", "matcher.window: given before"}}});
}

TEST(PlanRefusals, AreForCalibrationsThatAreNoFileOrVary) {
  const std::string rule = ": the file of a calibration, as written by stereotlm calibrate";
  expect_refusals({{"run: {calibration: [a.yaml]}\n", {rule}},
                   {"run: {calibration: \"\"}\n", {rule}},
                   {"run: {calibration: null}\n", {rule}},
                   {"vary: {run.calibration: [a.yaml, b.yaml]}\n",
                    {":2:8: vary: run.calibration: can only be given in `run`: one for all points"}}});
}

std::vector<std::uint64_t> shuffled(std::uint64_t size, std::uint64_t seed) {
  std::vector<std::uint64_t> all;
  for (std::uint64_t place = 0; place < size; ++place) all.push_back(shuffled_number(size, seed, place));
  return all;
}

TEST(ShuffledNumber, HoldsEachNumberOnce) {
  for (const std::uint64_t size : {1U, 2U, 3U, 4U, 5U, 16U, 17U, 1000U, 4097U}) {
    std::vector<std::uint64_t> numbers = shuffled(size, 7);
    std::sort(numbers.begin(), numbers.end());
    for (std::uint64_t i = 0; i < size; ++i) ASSERT_EQ(numbers[i], i) << size;
  }
}

// Users keep the samples of their seeds.
TEST(ShuffledNumber, IsTheSameInAllVersions) {
  EXPECT_THAT(shuffled(10, 1), ElementsAre(3, 9, 4, 0, 7, 8, 1, 2, 5, 6));
  EXPECT_THAT(shuffled(10, 2), ElementsAre(9, 3, 2, 4, 5, 7, 1, 0, 6, 8));
  EXPECT_EQ(shuffled_number(std::uint64_t{1} << 62U, 3, 5), 1531606549272710020U);
}

}  // namespace
}  // namespace stereotlm::explore
