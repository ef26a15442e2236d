#include "sw/report/difference_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace stereotlm::report {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

platform::BoardValue integer(const std::string& path, std::int64_t value) { return {path, value}; }

std::size_t lines_of(const std::string& text) {
  EXPECT_TRUE(text.empty() || text.back() == '\n') << "the last line has no end";
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::string settings(const Values& a, const Values& b) {
  return settings_table("board", differing_values(a, b));
}

// The words of each line with one space between them.
std::string words(const std::string& text) {
  std::string words;
  for (const char c : text) {
    if (c != ' ' || (!words.empty() && words.back() != ' ' && words.back() != '\n')) words += c;
  }
  return words;
}

TEST(DiffVerdict, TakesNoDifferenceWithinTheUncertaintyForAGain) {
  const auto stats = [](double steady, double uncertainty) {
    nlohmann::ordered_json json = {
        {"frames", 2}, {"frame_cycles", {500, 500}}, {"blame", nlohmann::ordered_json::array()}};
    json["frames_per_second"] = {{"core", 40}, {"steady", steady}, {"steady_uncertainty", uncertainty}};
    return json;
  };
  const auto verdict = [&stats](double steady, double uncertainty) {
    const nlohmann::ordered_json a = stats(20, 0.25);
    const nlohmann::ordered_json b = stats(steady, uncertainty);
    return diff_verdict({a, 40}, {b, 40}, nullptr);
  };
  EXPECT_THAT(verdict(20.5, 0.25),
              StartsWith("A and B are equally fast within the uncertainty of 0.500 frames/s, "
                         "steady: the core is not faster in B"));
  EXPECT_THAT(verdict(20.5, 0.125), StartsWith("B is faster by 0.500 frames/s (2.50 %), steady: "));
  EXPECT_THAT(verdict(19.5, 0.25), StartsWith("A and B are equally fast within the uncertainty"));
  EXPECT_THAT(verdict(20, 0), StartsWith("A and B are equally fast, 20.000 frames/s, steady; "));
}

TEST(SettingsTable, GivesAValueThatDoesNotFitItsColumnLinesOfItsOwn) {
  const std::string value(200, 'k');
  EXPECT_THAT(settings({{"filter", value}}, {{"filter", std::string("none")}}),
              EndsWith("\n  filter\n    A  " + value + "\n    B  none\n"));
  const std::string fits(26, 'k');
  EXPECT_EQ(lines_of(settings({{"filter", fits}}, {integer("filter", 1)})), 2U);
  EXPECT_EQ(lines_of(settings({{"filter", fits}}, {{"filter", fits + "k"}})), 4U);
}

TEST(SettingsTable, CountsTheSettingsBeyondTheMost) {
  Values a;
  for (std::size_t i = 0; i < kMostSettings; ++i) a.push_back(integer("file" + std::to_string(i), 1));
  EXPECT_THAT(settings(a, {}), Not(HasSubstr("more")));
  a.push_back(integer("last", 1));
  const std::string table = settings(a, {});
  EXPECT_EQ(lines_of(table), kMostSettings + 2);
  EXPECT_THAT(table, EndsWith("\n  1 more\n"));
}

TEST(FramesTable, ShowsTheFramesThatCostOrGainMost) {
  std::vector<std::uint64_t> a;
  std::vector<std::uint64_t> b;
  for (std::size_t frame = 0; frame < kMostLines + 2; ++frame) {
    a.push_back(1000);
    b.push_back(frame == 4 ? 900 : 1001 + frame);
  }
  const std::string table = words(frames_table(a, b));
  EXPECT_EQ(lines_of(table), kMostLines + 2);
  EXPECT_THAT(table,
              HasSubstr("difference\nframe 2 1000 1003 +3\nframe 3 1000 1004 +4\nframe 4 1000 900 -100"));
  EXPECT_THAT(table, EndsWith("\n2 more lines, in all +3\n"));
}

TEST(FramesTable, WeighsALineByTheSumOfItsFrames) {
  std::vector<std::uint64_t> a(20, 1000);
  std::vector<std::uint64_t> b(20, 1001);
  for (std::size_t line = 0; line < kMostLines; ++line) {
    a.push_back(1000);
    b.push_back(1002 + line);
  }
  const std::string table = words(frames_table(a, b));
  EXPECT_EQ(lines_of(table), kMostLines + 2);
  EXPECT_THAT(table, HasSubstr("difference\neach of 20 frames, the first is 0 1000 1001 +1\n"));
  EXPECT_THAT(table, EndsWith("\n1 more lines, in all +2\n"));
}

fpga::RowProfile rows_of(const std::vector<std::uint64_t>& ends, std::uint64_t stalls) {
  fpga::RowProfile rows;
  for (const std::uint64_t end : ends) rows.push_back({end, {0, 0, 0, 0, stalls}});
  return rows;
}

TEST(RowsTable, ShowsRowsOfWhichOnlyTheStallsDiffer) {
  const std::string head =
      "every row is whole after as many cycles in both; the waits differ from frame 1, row 1 on\n";
  const fpga::RowProfile stalled = {{10, {0, 0, 0, 0, 0}}, {20, {0, 0, 0, 0, 4}}};
  stats::RowComparison rows;
  rows.add(rows_of({10, 20}, 0), rows_of({10, 20}, 0));
  rows.add(rows_of({10, 20}, 0), stalled);
  const std::string table = rows_table(rows);
  EXPECT_EQ(lines_of(table), 4U);
  EXPECT_THAT(table, StartsWith(head));
  EXPECT_THAT(words(table), EndsWith("\n1 0 0 0 0 0 0 +4\n"));
  rows.add(stalled, rows_of({10, 20}, 0));
  EXPECT_EQ(rows_table(rows), head) << "one frame gains the cycles that another one loses";
}

}  // namespace
}  // namespace stereotlm::report
