#include "sw/explore/plan/conditions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "platform/config/board_yaml.h"

namespace stereotlm::explore {
namespace {

using ::testing::HasSubstr;

Conditions of(const std::vector<std::string>& texts) {
  std::vector<Condition> conditions;
  for (const std::string& text : texts) conditions.push_back({text, "plan.yaml:3:9", "where = " + text});
  return Conditions(conditions);
}

bool holds(const std::string& text, const std::vector<std::string>& sets = {}) {
  auto values = values_of(platform::load_board("fpl2003", sets));
  values.push_back({"run.source", "preloaded"});
  values.push_back({"run.frames", std::int64_t{6}});
  return of({text}).hold(values);
}

TEST(Conditions, CompareKeysOfTheBoardAsItsFileNamesThem) {
  EXPECT_TRUE(holds("image.width * image.height <= 307200"));
  EXPECT_FALSE(holds("image.width * image.height < 307200"));
  EXPECT_TRUE(holds("cameras.frame_rate_hz > 29.9 AND cameras.frame_rate_hz < 30"));
  EXPECT_TRUE(holds("matcher.filter = 'log7'"));
  EXPECT_TRUE(holds("allocation.left_image = '[bank0, bank1]'"));
  EXPECT_TRUE(holds("allocation.left_lut = 'none'", {"allocation.left_lut=none"}));
  EXPECT_TRUE(holds("board.name = 'fpl2003'"));
  EXPECT_TRUE(holds("ssram.banks = 8"));
  EXPECT_TRUE(holds("run.frames = 6 AND run.source = 'preloaded'"));
}

TEST(Conditions, TakeNullForNo) {
  EXPECT_FALSE(holds("NULL"));
  EXPECT_FALSE(holds("pci.\"load.burst_words\" = 32"));
  EXPECT_TRUE(holds("pci.\"load.burst_words\" IS NULL"));
}

TEST(Conditions, AllHaveToHold) {
  const auto values = values_of(platform::load_board("fpl2003"));
  EXPECT_TRUE(of({}).hold(values));
  EXPECT_TRUE(of({"image.width = 640", "image.height = 480"}).hold(values));
  EXPECT_FALSE(of({"image.width = 640", "image.height = 481"}).hold(values));
}

TEST(Conditions, MayBeAskedAgainForOtherBoards) {
  Conditions conditions = of({"image.width = 640"});
  EXPECT_TRUE(conditions.hold(values_of(platform::load_board("fpl2003"))));
  EXPECT_FALSE(conditions.hold(values_of(platform::load_board("fpl2003", {"image.width=320"}))));
  EXPECT_TRUE(conditions.hold(values_of(platform::load_board("fpl2003"))));
  Conditions of_load = of({"pci.\"load.burst_words\" = 8"});
  EXPECT_TRUE(of_load.hold(
      values_of(platform::load_board("fpl2003", {"pci.load={burst_words: 8, interval_us: 10}"}))));
  EXPECT_FALSE(of_load.hold(values_of(platform::load_board("fpl2003"))));
}

TEST(Conditions, CountAsBanksWhatLiesBelowThem) {
  const std::int64_t one = 1;
  EXPECT_TRUE(of({"ssram.banks = 2"})
                  .hold({{"ssram.banks.a.words", one},
                         {"ssram.default.words", one},
                         {"ssram.banks.a.turnaround_cycles", one},
                         {"ssram.banks.words.words", one}}));
}

std::string refusal(const std::string& text) {
  try {
    const Conditions conditions = of({text});
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

TEST(Conditions, AreRefusedWithTheReason) {
  const std::vector<std::pair<std::string, std::string>> refusals = {
      {"image.widht = 640", "no such column: image.widht"},
      {"clock_mhz = 40", "ambiguous column name: clock_mhz"},
      {"matcher.filter = \"log7\"", "no such column: log7"},
      {"image.width =", "incomplete input"},
      {"", "incomplete input"},
      {"board.name = 'fpl", "unrecognized token: \"'fpl\""},
      {"1)) /*", "near \")\": syntax error"},
      {"1)) UNION SELECT ((0", "near \")\": syntax error"},
      {"((1)", "incomplete input"},
      {"1 /* a comment", "incomplete input"},
      {"1; DELETE FROM points", "more than one statement"},
      {"1;", "near \";\": syntax error"},
      {"1, 2", "near \",\": syntax error"},
      {"1 LIMIT 0", "near \"LIMIT\": syntax error"},
      {"1 UNION SELECT 0", "near \"UNION\": syntax error"},
      {"SELECT 1", "near \"SELECT\": syntax error"},
      {"max(image.width) = 640", "misuse of aggregate function max()"},
  };
  for (const auto& [text, reason] : refusals) EXPECT_EQ(refusal(text), reason) << text;
  for (const std::string text : {"1 -- a comment", "1 /* a comment */", "(1)", "board.name <> ')' AND 1"})
    EXPECT_EQ(refusal(text), "") << text;
}

TEST(Conditions, AreRefusedInOneShortLine) {
  const std::string reason = refusal("board.name = 'fpl\n2003" + std::string(100'000, 'x'));
  EXPECT_THAT(reason, HasSubstr("unrecognized token: \"'fpl 2003xxx"));
  EXPECT_LT(reason.size(), 100U);
}

TEST(Conditions, HaveNoParameters) {
  for (const std::string text : {"?", "?1 = 640", "image.width > ?7", ":x", "@x", "$x", "coalesce(:x, 1)"})
    EXPECT_EQ(refusal(text), "parameters such as ? and :x have no value") << text;
}

TEST(Conditions, DependOnNothingButThePoint) {
  for (const std::string call :
       {"random()", "randomblob(4)", "changes()", "total_changes()", "last_insert_rowid()", "date('now')",
        "time()", "datetime('now')", "julianday('now')", "unixepoch('now')", "strftime('%s')", "current_time",
        "current_date", "current_timestamp", "load_extension('x')", "sqlite_version()", "count(*)",
        "MATCH('a', 'b')"}) {
    EXPECT_THAT(refusal(call + " IS NOT NULL"), HasSubstr("() depends on more than its arguments")) << call;
  }
  EXPECT_THAT(refusal("board.name MATCH 'fpl*'"), HasSubstr("match() depends on more than its arguments"));
  for (const std::string select :
       {"SELECT 1 FROM sqlite_schema", "SELECT name FROM sqlite_schema",
        "SELECT 1 FROM pragma_table_info('x')", "SELECT 1 FROM pragma_database_list",
        "SELECT value FROM json_each('[1]')"}) {
    EXPECT_EQ(refusal("(" + select + ") IS NOT NULL"), "reads more than the point") << select;
  }
  EXPECT_EQ(refusal("(WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i FROM n) > 0"),
            "reads more than the point");
  EXPECT_TRUE(holds("(SELECT image.width + 1) = 641"));
  EXPECT_TRUE(
      holds("max(image.width, 1) = 640 AND min(1, 2) = 1 AND abs(-1) = 1 AND board.name LIKE 'FPL%'"));
  EXPECT_TRUE(holds("json_array_length('[1, 2]') = 2 AND iif(ssram.banks = 8, 1, 0)"));
}

TEST(Conditions, SayWhatCannotBeComputed) {
  const std::vector<std::pair<std::string, std::string>> failures = {
      {"abs(-9223372036854775808) > 0", "integer overflow"},
      {"json('{bad') = 1", "malformed JSON"},
      {"abs(image.width - 9223372036854775807 - 641) > 0", "integer overflow"},
  };
  for (const auto& [text, reason] : failures) {
    try {
      holds(text);
      FAIL() << text;
    } catch (const ConditionError& error) {
      EXPECT_EQ(error.reason, reason);
      EXPECT_EQ(error.what(), "plan.yaml:3:9: where = " + text + ": " + reason);
    }
  }
}

}  // namespace
}  // namespace stereotlm::explore
