#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/explore/plan/points.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {
namespace {

using ::testing::HasSubstr;
using Sets = std::vector<std::string>;

Conditions conditions(const std::vector<std::string>& texts) {
  std::vector<Condition> conditions;
  for (const std::string& text : texts) conditions.push_back({text, "plan.yaml:3:9", "where = " + text});
  return Conditions(conditions);
}

// The values of a point of the preset fpl2003 with some keys set.
std::vector<platform::BoardValue> point(const Sets& sets = {}) {
  auto values = values_of(platform::load_board("fpl2003", sets));
  values.push_back({"run.source", "preloaded"});
  values.push_back({"run.frames", std::int64_t{6}});
  return values;
}

TEST(Conditions, CompareKeysThatHaveTheirNamesInABoardFile) {
  struct Case {
    std::string text;
    bool holds;
    Sets sets;
  };
  const std::vector<Case> cases = {
      {"image.width * image.height <= 307200", true, {}},
      {"image.width * image.height < 307200", false, {}},
      {"cameras.frame_rate_hz > 29.9 AND cameras.frame_rate_hz < 30", true, {}},
      {"matcher.filter = 'log7'", true, {}},
      {"allocation.left_image = '[bank0, bank1]'", true, {}},
      {"allocation.left_lut = 'none'", true, {"allocation.left_lut=none"}},
      {"matcher.units = 'all' AND matcher.rows = 1 AND matcher.cost = 'sad'", true, {}},
      {"fpga.tables = 'separate' AND fpga.pixel_cache = 'none'", true, {}},
      {"2 * matcher.units <= matcher.disparities", true, {"matcher.units=40"}},
      {"2 * matcher.units <= matcher.disparities", false, {"matcher.units=41"}},
      {"matcher.cost = '{census: 5}'", true, {"matcher.cost={census: 5}"}},
      {"matcher.cost LIKE '%census%'", false, {"matcher.cost=zncc"}},
      {"board.name = 'fpl2003'", true, {}},
      {"ssram.banks = 8", true, {}},
      {"run.frames = 6 AND run.source = 'preloaded'", true, {}},
      {"window = 7 AND MATCHER.\"Window\" = 7 AND [image].`width` = 640", true, {}},
      {"1 + 1 = 2", true, {}},
      {"NULL", false, {}},
      {"pci.\"load.burst_words\" = 32", false, {}},
      {"pci.\"load.burst_words\" IS NULL", true, {}},
      {"pci.\"load.burst_words\" = 8", true, {"pci.load={burst_words: 8, interval_us: 10}"}},
      {"pci.load.burst_words = 8 AND 'pci.load.access_us' = 'pci.load.' || 'access_us'",
       true,
       {"pci.load={burst_words: 8, interval_us: 10}"}},
      {"image.width BETWEEN pci.load.burst_words+1 AND 641",
       true,
       {"pci.load={burst_words: 8, interval_us: 10}"}},
      {"1 -- it's\n AND pci.load.burst_words = 8", true, {"pci.load={burst_words: 8, interval_us: 10}"}},
      {"1 /* it's */ AND pci.load.burst_words = 8", true, {"pci.load={burst_words: 8, interval_us: 10}"}},
      {"(SELECT \"x y.z.w\" FROM (SELECT 1 AS \"x y.z.w\")) = 1", true, {}},
      {"(SELECT image.width + 1) = 641", true, {}},
      {"max(image.width, 1) = 640 AND min(1, 2) = 1 AND abs(-1) = 1 AND board.name LIKE 'FPL%'", true, {}},
      {"json_array_length('[1, 2]') = 2 AND iif(ssram.banks = 8, 1, 0)", true, {}}};
  for (const Case& one : cases)
    EXPECT_EQ(conditions({one.text}).hold(point(one.sets)), one.holds) << one.text;
}

TEST(Conditions, HoldIfAllOfThemAreTrue) {
  EXPECT_TRUE(conditions({}).hold(point()));
  EXPECT_TRUE(conditions({"image.width = 640", "image.height = 480"}).hold(point()));
  EXPECT_FALSE(conditions({"image.width = 640", "image.height = 481"}).hold(point()));
}

TEST(Conditions, ForgetTheValuesOfThePointBefore) {
  Conditions of_width = conditions({"image.width = 640"});
  Conditions of_load = conditions({"pci.\"load.burst_words\" = 8"});
  for (int time = 0; time < 2; ++time) {
    EXPECT_TRUE(of_width.hold(point()));
    EXPECT_FALSE(of_width.hold(point({"image.width=320"})));
    EXPECT_TRUE(of_load.hold(point({"pci.load={burst_words: 8, interval_us: 10}"})));
    EXPECT_FALSE(of_load.hold(point()));
  }
}

TEST(Conditions, GiveTheNumberOfAnExpressionOnEachBoard) {
  const Condition text = {"ssram.banks * matcher.window + run.frames * pins + length(board.name)", "here",
                          "x"};
  Conditions expression({text}, {"pins"});
  const auto number = [&](const Sets& sets, std::int64_t frames, double pins) {
    return expression.number(platform::load_board("fpl2003", sets),
                             {{"run.frames", frames}, {"run.source", "camera"}, {"pins", pins}});
  };
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(number({}, 2, 0.5), 8 * 7 + 2 * 0.5 + 7);
    EXPECT_EQ(number({"matcher.window=5"}, 2, 0.5), 8 * 5 + 2 * 0.5 + 7);
    EXPECT_EQ(number({"matcher.window=5"}, 3, 0.5), 8 * 5 + 3 * 0.5 + 7);
    EXPECT_EQ(number({"ssram.banks.more={}"}, 3, 0.25), 9 * 7 + 3 * 0.25 + 7);
  }
  EXPECT_EQ(Conditions({{"pci.\"load.burst_words\"", "", ""}}).number(platform::load_board("fpl2003"), {}),
            std::nullopt);
}

TEST(Conditions, CountBanksByTheirWords) {
  const std::int64_t one = 1;
  EXPECT_TRUE(conditions({"ssram.banks = 2"})
                  .hold({{"ssram.banks.a.words", one},
                         {"ssram.default.words", one},
                         {"ssram.banks.a.turnaround_cycles", one},
                         {"ssram.banks.words.words", one}}));
}

// The reason for which a text is refused; empty if it is an expression.
std::string reason_against(const std::string& text) {
  try {
    const Conditions compiled = conditions({text});
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

TEST(Conditions, AreRefusedWithTheReason) {
  // [reason]: texts; without a reason they are expressions
  const std::vector<std::pair<std::string, std::vector<std::string>>> refusals = {
      {"no such column: image.widht; nearest: image.width", {"image.widht = 640"}},
      {"no such column: windw; nearest: matcher.window", {"windw > 5"}},
      {"no such column: matcher.window; write the key without quotes", {"\"matcher.window\" > 5"}},
      {"no such column: frames_per_second.core; a figure is not known before the point is simulated",
       {"frames_per_second.core > 5"}},
      {"ambiguous column name: clock_mhz", {"clock_mhz = 40"}},
      {"no such column: log7", {"matcher.filter = \"log7\""}},
      {"incomplete input", {"image.width =", "", "((1)", "1 /* a comment"}},
      {"unrecognized token: \"'fpl\"", {"board.name = 'fpl"}},
      {"near \")\": syntax error", {"1)) /*", "1)) UNION SELECT ((0"}},
      {"more than one statement", {"1; DELETE FROM points"}},
      {"near \";\": syntax error", {"1;"}},
      {"near \",\": syntax error", {"1, 2"}},
      {"near \"LIMIT\": syntax error", {"1 LIMIT 0"}},
      {"near \"UNION\": syntax error", {"1 UNION SELECT 0"}},
      {"near \"SELECT\": syntax error", {"SELECT 1"}},
      {"misuse of aggregate function max()", {"max(image.width) = 640"}},
      {"parameters such as ? and :x have no value",
       {"?", "?1 = 640", "image.width > ?7", ":x", "@x", "$x", "coalesce(:x, 1)"}},
      {"reads more than the point",
       {"(SELECT 1 FROM sqlite_schema) IS NOT NULL", "(SELECT name FROM sqlite_schema) IS NOT NULL",
        "(SELECT 1 FROM pragma_table_info('x')) > 0", "(SELECT 1 FROM pragma_database_list) > 0",
        "(SELECT value FROM json_each('[1]')) > 0",
        "(WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i FROM n) > 0"}},
      {"printf() may take any time", {"printf('%.*c', 1000000000, 'x') = 'x'", "PRINTF('') = 'x'"}},
      {"format() may take any time", {"format('%.*c', 1000000000, 'x') = 'x'"}},
      {"match() depends on more than its arguments", {"board.name MATCH 'fpl*'"}},
      {"", {"1 -- a comment", "1 /* a comment */", "(1)", "board.name <> ')' AND 1"}}};
  for (const auto& [reason, texts] : refusals) {
    for (const std::string& text : texts) EXPECT_EQ(reason_against(text), reason) << text;
  }
  for (const std::string call :
       {"random()", "randomblob(4)", "changes()", "total_changes()", "last_insert_rowid()", "date('now')",
        "time()", "datetime('now')", "julianday('now')", "unixepoch('now')", "strftime('%s')", "current_time",
        "current_date", "current_timestamp", "load_extension('x')", "sqlite_version()", "count(*)",
        "MATCH('a', 'b')"})
    EXPECT_THAT(reason_against(call + " IS NOT NULL"), HasSubstr("() depends on more than its arguments"))
        << call;
}

TEST(Conditions, AreRefusedInOneShortLine) {
  const std::string reason = reason_against("board.name = 'fpl\n2003" + std::string(100'000, 'x'));
  EXPECT_THAT(reason, HasSubstr("unrecognized token: \"'fpl 2003xxx"));
  EXPECT_LT(reason.size(), 100U);
}

// Without the limits they would take a GB, or 10^8 rows.
TEST(Conditions, ReportWhyTheyCannotBeComputedForAPoint) {
  const std::string rows = "(VALUES (1), (2), (3), (4), (5), (6), (7), (8), (9), (10)) AS ";
  const std::string join = "EXISTS (SELECT 1 FROM " + rows + "a, " + rows + "b, " + rows + "c, " + rows +
                           "d, " + rows + "e, " + rows + "f, " + rows + "g, " + rows +
                           "h WHERE a.column1 + b.column1 + " +
                           "c.column1 + d.column1 + e.column1 + f.column1 + g.column1 + h.column1 = 0)";
  const std::vector<std::pair<std::string, std::string>> failures = {
      {"abs(-9223372036854775808) > 0", "integer overflow"},
      {"json('{bad') = 1", "malformed JSON"},
      {"length(hex(zeroblob(100000000))) > 0", "a text must be at most 20000 bytes"},
      {join, "must be computed within 1000000 steps of SQLite"},
      {"abs(image.width - 9223372036854775807 - 641) > 0", "integer overflow"}};
  for (const auto& [text, reason] : failures)
    EXPECT_EQ(test::message_of([&text = text] { conditions({text}).hold(point()); }),
              "plan.yaml:3:9: where = " + text + ": " + reason);
}

TEST(Conditions, LimitTheStepsOfEachPointAlone) {
  Conditions compiled = conditions({"image.width > 0"});
  const std::vector<platform::BoardValue> values = point();
  for (int i = 0; i < 20'000; ++i) ASSERT_TRUE(compiled.hold(values));
}

}  // namespace
}  // namespace stereotlm::explore
