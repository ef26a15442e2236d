#include "sw/report/difference_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stereotlm::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

platform::BoardValue integer(const std::string& path, std::int64_t value) { return {path, value}; }

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::string line;
  for (const char c : text) {
    if (c != '\n') {
      line += c;
      continue;
    }
    lines.push_back(line);
    line.clear();
  }
  EXPECT_EQ(line, "") << "the last line has no end";
  return lines;
}

// Words of a line, with one space between.
std::string words(const std::string& line) {
  std::string text;
  for (const char c : line) {
    if (c != ' ' || (!text.empty() && text.back() != ' ')) text += c;
  }
  return text;
}

TEST(SettingsTable, IsEmptyWhereNothingDiffers) {
  EXPECT_EQ(settings_table("board", {integer("a", 1)}, {integer("a", 1)}), "");
}

TEST(SettingsTable, HasTheValuesThatDiffer) {
  const auto lines = lines_of(settings_table(
      "board",
      {{"name", std::string("x")}, integer("same", 1), integer("image.width", 640), integer("load", 5)},
      {{"name", std::string("y")}, integer("same", 1), integer("image.width", 320), {"new", 2.5}}));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(words(lines[0]), "board A B");
  EXPECT_EQ(words(lines[1]), "name x y");
  EXPECT_EQ(words(lines[2]), "image.width 640 320");
  EXPECT_EQ(words(lines[3]), "load 5 -");
  EXPECT_EQ(words(lines[4]), "new - 2.5");
}

TEST(SettingsTable, HasLongValuesInFull) {
  const std::string value(200, 'k');
  const auto lines =
      lines_of(settings_table("board", {{"filter", value}}, {{"filter", std::string("none")}}));
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[1], "  filter");
  EXPECT_EQ(lines[2], "    A  " + value);
  EXPECT_EQ(lines[3], "    B  none");
}

TEST(SettingsTable, HasAColumnForAsManyCharactersAsFit) {
  const std::string fits(26, 'k');
  const auto in_full = lines_of(settings_table("board", {{"filter", fits}}, {{"filter", fits + "k"}}));
  EXPECT_EQ(in_full.size(), 4U);
  EXPECT_EQ(lines_of(settings_table("board", {{"filter", fits}}, {integer("filter", 1)})).size(), 2U);
}

TEST(SettingsTable, EndsAfterTheMost) {
  Values a;
  for (std::size_t i = 0; i < kMostSettings; ++i) a.push_back(integer("file" + std::to_string(i), 1));
  EXPECT_THAT(settings_table("run", a, {}), Not(HasSubstr("more")));
  a.push_back(integer("last", 1));
  const auto lines = lines_of(settings_table("run", a, {}));
  EXPECT_EQ(lines.size(), kMostSettings + 2);
  EXPECT_EQ(lines.back(), "  1 more");
}

TEST(FiguresTable, HasNumbersWithTheirDifferences) {
  const auto lines = lines_of(figures_table("totals",
                                            {integer("cycles", 100),
                                             {"rate", 18.5},
                                             {"by", std::string("matcher")},
                                             integer("whole", 40),
                                             integer("same", 1)},
                                            {integer("cycles", 250),
                                             {"rate", 9.25},
                                             {"by", std::string("bank")},
                                             {"whole", 40.5},
                                             integer("same", 1)}));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(words(lines[0]), "totals A B difference");
  EXPECT_EQ(words(lines[1]), "cycles 100 250 +150");
  EXPECT_EQ(words(lines[2]), "rate 18.5 9.25 -9.25");
  EXPECT_EQ(words(lines[3]), "by matcher bank");
  EXPECT_EQ(words(lines[4]), "whole 40 40.5 +0.5");
  EXPECT_EQ(figures_table("totals", {integer("same", 1)}, {integer("same", 1)}), "");
}

TEST(FramesTable, PutsFramesWithTheSameCyclesTogether) {
  const auto lines = lines_of(frames_table({10, 10, 10, 12, 10}, {20, 10, 20, 11, 10, 99}));
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(words(lines[0]), "cycles of a frame A B difference");
  EXPECT_EQ(words(lines[1]), "each of 2 frames, the first is 0 10 20 +10");
  EXPECT_EQ(words(lines[2]), "each of 2 frames, the first is 1 10 10 0");
  EXPECT_EQ(words(lines[3]), "frame 3 12 11 -1");
  EXPECT_EQ(frames_table({10, 11}, {10, 11, 12}), "");
}

TEST(FramesTable, ShowsThoseThatCostOrGainMost) {
  std::vector<std::uint64_t> a;
  std::vector<std::uint64_t> b;
  for (std::size_t frame = 0; frame < kMostLines + 2; ++frame) {
    a.push_back(1000);
    b.push_back(frame == 4 ? 900 : 1001 + frame);
  }
  const auto lines = lines_of(frames_table(a, b));
  ASSERT_EQ(lines.size(), kMostLines + 2);
  EXPECT_EQ(words(lines[1]), "frame 2 1000 1003 +3");
  EXPECT_EQ(words(lines[3]), "frame 4 1000 900 -100");
  EXPECT_EQ(words(lines.back()), "2 more lines, in all +3");
}

TEST(FramesTable, WeighsALineWithAllItsFrames) {
  std::vector<std::uint64_t> a(20, 1000);
  std::vector<std::uint64_t> b(20, 1001);
  for (std::size_t line = 0; line < kMostLines; ++line) {
    a.push_back(1000);
    b.push_back(1002 + line);
  }
  const auto lines = lines_of(frames_table(a, b));
  ASSERT_EQ(lines.size(), kMostLines + 2);
  EXPECT_EQ(words(lines[1]), "each of 20 frames, the first is 0 1000 1001 +1");
  EXPECT_EQ(words(lines.back()), "1 more lines, in all +2");
}

fpga::RowProfile rows_of(const std::vector<std::uint64_t>& ends, std::uint64_t stalls) {
  fpga::RowProfile rows;
  for (const std::uint64_t end : ends) rows.push_back({end, {0, 0, 0, 0, stalls}});
  return rows;
}

TEST(RowsTable, SaysWhereTheyPartAndWhatItCosts) {
  RowComparison rows;
  EXPECT_EQ(rows_table(rows), "");
  rows.add(rows_of({10, 20, 30, 40}, 0), rows_of({10, 25, 40, 48}, 3));
  const auto lines = lines_of(rows_table(rows));
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_EQ(lines[0], "they part in frame 0, row 1: whole after 20 cycles in A, 25 in B");
  EXPECT_EQ(words(lines[1]), "stall cycles of");
  EXPECT_EQ(words(lines[2]), "rows difference each row left_lut right_lut left_pixel right_pixel result");
  EXPECT_EQ(words(lines[3]), "0 0 0 0 0 0 0 +3");
  EXPECT_EQ(words(lines[4]), "1..2 +10 +5 0 0 0 0 0");
  EXPECT_EQ(words(lines[5]), "3 -2 -2 0 0 0 0 0");
}

TEST(RowsTable, HasBandsOfManyRows) {
  RowComparison rows;
  std::vector<std::uint64_t> ends;
  std::vector<std::uint64_t> others;
  for (std::uint64_t row = 0; row < 4 * kMostLines; ++row) {
    ends.push_back(10 * (row + 1));
    others.push_back(ends.back() + row * (row + 1) / 2);
  }
  rows.add(rows_of(ends, 0), rows_of(others, 0));
  const auto lines = lines_of(rows_table(rows));
  ASSERT_EQ(lines.size(), kMostLines + 3);
  EXPECT_EQ(words(lines[3]), "0..3 +6 0..+3 0 0 0 0 0");
  EXPECT_EQ(words(lines[4]), "4..7 +22 +4..+7 0 0 0 0 0");
}

TEST(RowsTable, OnlyNamesTheRowWhereFramesMakeUpForEachOther) {
  RowComparison rows;
  rows.add(rows_of({10}, 0), rows_of({20}, 0));
  rows.add(rows_of({20}, 0), rows_of({10}, 0));
  EXPECT_EQ(rows_table(rows), "they part in frame 0, row 0: whole after 10 cycles in A, 20 in B\n");
}

TEST(RowsTable, HasRowsOfWhichOnlyTheStallsAreOthers) {
  RowComparison rows;
  rows.add(rows_of({10, 20}, 0), rows_of({10, 20}, 0));
  rows.add(rows_of({10, 20}, 0), {{10, {0, 0, 0, 0, 0}}, {20, {0, 0, 0, 0, 4}}});
  const auto lines = lines_of(rows_table(rows));
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0],
            "every row is whole after as many cycles in both; stalls are others from frame 1, row 1");
  EXPECT_EQ(words(lines[3]), "1 0 0 0 0 0 0 +4");
  rows.add({{10, {0, 0, 0, 0, 0}}, {20, {0, 0, 0, 0, 4}}}, rows_of({10, 20}, 0));
  EXPECT_EQ(rows_table(rows), lines[0] + '\n') << "what one frame loses another one gains";
}

TEST(BlameTable, IsSortedByWhatItDiffers) {
  const std::vector<platform::BlameRow> a = {{"left_lut", "bank0", "host", 10},
                                             {"result", "bank1", "host", 5}};
  const std::vector<platform::BlameRow> b = {{"left_lut", "bank0", "host", 15},
                                             {"result", "bank1", "host", 5},
                                             {"result", "bank1", "turnaround", 90}};
  const auto lines = lines_of(blame_table(a, b));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(words(lines[0]), "cycles lost A B difference");
  EXPECT_EQ(words(lines[1]), "result on bank1 to turnaround 0 90 +90");
  EXPECT_EQ(words(lines[2]), "left_lut on bank0 to host 10 15 +5");
  EXPECT_THAT(blame_table(b, a), HasSubstr("-90\n"));
  EXPECT_EQ(blame_table(a, a), "");
}

TEST(PixelsLine, SaysThatNoFrameIsInBoth) {
  EXPECT_EQ(pixels_line(PixelComparison()), "disparities: not compared: no camera frame is in both\n");
}

TEST(PixelsLine, SaysHowManyDifferAndWhereTheFirstIs) {
  PixelComparison pixels;
  kernels::GrayImage image(4, 2, 7);
  pixels.add(0, image, image);
  EXPECT_EQ(pixels_line(pixels), "disparities: the same, pixel for pixel, in 1 frame\n");
  kernels::GrayImage other = image;
  other.at(2, 1) = 255;
  pixels.add(4, image, other);
  EXPECT_EQ(
      pixels_line(pixels),
      "disparities: 1 pixel differs, in 1 of 2 frames; the first in frame 4 at (2, 1): 7 in A, 255 in B\n");
}

}  // namespace
}  // namespace stereotlm::report
