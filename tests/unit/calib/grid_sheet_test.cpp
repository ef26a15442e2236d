#include "calib/grid_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace stereotlm::calib {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;

// The numbers of `pattern` at each of its places.
std::vector<std::vector<double>> numbers_of(const std::string& text, const std::string& pattern) {
  const std::regex place(pattern);
  std::vector<std::vector<double>> found;
  for (std::sregex_iterator match(text.begin(), text.end(), place); match != std::sregex_iterator();
       ++match) {
    found.emplace_back();
    for (std::size_t i = 1; i < match->size(); ++i) found.back().push_back(std::stod((*match)[i]));
  }
  return found;
}

// Width and height of the page, in millimetres.
std::vector<double> page_of(const std::string& svg) {
  const auto pages = numbers_of(svg, R"re(width="([\d.]+)mm" height="([\d.]+)mm" viewBox="0 0 \1 \2">)re");
  return pages.size() == 1 ? pages.front() : std::vector<double>();
}

// The left, the top, and the three lengths that draw each square, in millimetres.
std::vector<std::vector<double>> squares_of(const std::string& svg) {
  return numbers_of(svg, R"(M([\d.]+) ([\d.]+)h([\d.]+)v([\d.]+)h-([\d.]+)z)");
}

// A page leaves 10 mm for the small print.
TEST(GridSheet, IsTheFirstPageWithAWhiteMarginOrMadeToMeasure) {
  struct Page {
    GridShape shape;
    double width_mm, height_mm;
  };
  const Page pages[] = {
      // Half a square white: 7 + 1 squares, then 10 + 1 squares on a page that stands upright.
      {{9, 6, 25}, 297, 210},
      {{9, 6, 25.01}, 420, 297},
      {{6, 9, 25}, 210, 297},
      {{6, 9, 26.09}, 210, 297},
      {{6, 9, 26.1}, 297, 420},
      {{9, 6, 35.875}, 420, 297},
      // At least 10 mm white: 18 squares and 20 mm.
      {{21, 17, 10}, 297, 210},
      {{21, 17, 10.01}, 420, 297},
      // Less than half a square white if no page has more: 7 squares and 20 mm.
      {{9, 6, 35.9}, 420, 297},
      {{9, 6, 38.14}, 420, 297},
      // Beyond A3 made to measure.
      {{9, 6, 38.15}, 11 * 38.15, 8 * 38.15 + 10},
      {{9, 6, 50}, 550, 410},
      {{3, 100, 5}, 210, 101 * 5 + 30},
  };
  for (const auto& [shape, width_mm, height_mm] : pages) {
    EXPECT_THAT(page_of(grid_sheet_svg(shape)), ElementsAre(DoubleEq(width_mm), DoubleEq(height_mm)))
        << shape.square_mm;
  }
}

TEST(GridSheet, HasTheSmallPrint) {
  const std::string svg = grid_sheet_svg({9, 6, 25});
  EXPECT_THAT(svg, HasSubstr(">100 mm</text>"));
  EXPECT_THAT(svg, HasSubstr(">9x6 inner corners, squares of 25 mm: print at 100 %</text>"));
}

// A browser then adds no margin, and does not choose another page.
TEST(GridSheet, SetsThePageOfThePrinter) {
  EXPECT_THAT(grid_sheet_svg({9, 6, 50.5}), HasSubstr("@page { size: 555.5mm 414mm; margin: 0 }"));
}

// In the middle of A4 above the small print.
TEST(GridSheet, HasEverySecondSquareAtItsPlace) {
  for (const double square_mm : {20.0, 24.7}) {
    const double left = (297 - 10 * square_mm) / 2;
    const double top = (210 - 10 - 7 * square_mm) / 2;
    std::set<std::pair<int, int>> found;
    for (const auto& square : squares_of(grid_sheet_svg({9, 6, square_mm}))) {
      const auto column = std::lround((square[0] - left) / square_mm);
      const auto row = std::lround((square[1] - top) / square_mm);
      found.insert({static_cast<int>(column), static_cast<int>(row)});
      EXPECT_NEAR(square[0], left + static_cast<double>(column) * square_mm, 1e-6);
      EXPECT_NEAR(square[1], top + static_cast<double>(row) * square_mm, 1e-6);
      for (int side = 2; side < 5; ++side) EXPECT_EQ(square[side], square_mm);
    }
    std::set<std::pair<int, int>> expected;
    for (int row = 0; row < 7; ++row) {
      for (int column = row % 2; column < 10; column += 2) expected.insert({column, row});
    }
    EXPECT_EQ(expected.size(), 35U);
    EXPECT_EQ(found, expected);
  }
}

TEST(GridSheet, HasARulerOf100MmBetweenTheBoardAndTheEdge) {
  const std::string svg = grid_sheet_svg({9, 6, 25});
  EXPECT_THAT(svg, HasSubstr("\"M49.5 205h100M"));
  const auto ticks = numbers_of(svg, R"(M([\d.]+) 205v-([\d.]+))");
  ASSERT_EQ(ticks.size(), 11U);
  for (std::size_t tick = 0; tick < ticks.size(); ++tick) {
    EXPECT_DOUBLE_EQ(ticks[tick][0], 49.5 + 10 * static_cast<double>(tick));
    EXPECT_LT(ticks[tick][1], 5);  // half a square is white below the board
  }
}

}  // namespace
}  // namespace stereotlm::calib
