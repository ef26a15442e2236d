#include "calib/grid_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/scratch_folder.h"

namespace stereotlm::calib {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string refusal_of(const GridShape& shape) {
  return test::message_of([&shape] { grid_sheet(shape); });
}

// The numbers in the attributes of every element that begins with these attributes.
std::vector<std::vector<double>> elements_of(const std::string& svg, const std::string& name,
                                             const std::vector<std::string>& attributes) {
  std::string pattern = "<" + name;
  for (const std::string& attribute : attributes) pattern += " " + attribute + "=\"([^\"]*)\"";
  const std::regex element(pattern);
  std::vector<std::vector<double>> found;
  for (std::sregex_iterator match(svg.begin(), svg.end(), element); match != std::sregex_iterator();
       ++match) {
    found.emplace_back();
    for (std::size_t i = 1; i <= attributes.size(); ++i) found.back().push_back(std::stod((*match)[i]));
  }
  return found;
}

std::array<double, 4> media_box(const std::string& pdf) {
  std::smatch found;
  const std::regex box(R"(/MediaBox \[ (\S+) (\S+) (\S+) (\S+) \])");
  if (!std::regex_search(pdf, found, box)) return {};
  return {std::stod(found[1]), std::stod(found[2]), std::stod(found[3]), std::stod(found[4])};
}

TEST(GridShape, HasNoProblemsWithinItsRanges) {
  EXPECT_THAT(problems(GridShape{3, 100, 1}), IsEmpty());
  EXPECT_THAT(problems(GridShape{100, 3, 1000}), IsEmpty());
}

TEST(GridShape, NamesEveryFieldOutsideItsRange) {
  EXPECT_THAT(problems(GridShape{2, 101, 0.5}),
              ElementsAre("columns = 2: must be 3..100 inner corners",
                          "rows = 101: must be 3..100 inner corners", "square_mm = 0.5: must be 1..1000"));
  EXPECT_THAT(problems(GridShape{101, 2, 1000.5}),
              ElementsAre("columns = 101: must be 3..100 inner corners",
                          "rows = 2: must be 3..100 inner corners", "square_mm = 1000.5: must be 1..1000"));
  EXPECT_THAT(problems(GridShape{9, 6, kNan}), ElementsAre("square_mm = nan: must be 1..1000"));
  EXPECT_THAT(problems(GridShape{9, 6, kInfinity}), ElementsAre("square_mm = inf: must be 1..1000"));
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
  for (const Page& page : pages) {
    const GridSheet sheet = grid_sheet(page.shape);
    EXPECT_DOUBLE_EQ(sheet.width_mm, page.width_mm) << page.shape.square_mm;
    EXPECT_DOUBLE_EQ(sheet.height_mm, page.height_mm) << page.shape.square_mm;
  }
}

TEST(GridSheet, HasTheBoardInTheMiddleAboveTheSmallPrint) {
  const GridSheet sheet = grid_sheet({9, 6, 20});
  EXPECT_DOUBLE_EQ(sheet.board_left_mm, (297 - 200) / 2.0);
  EXPECT_DOUBLE_EQ(sheet.board_top_mm, (210 - 10 - 140) / 2.0);
}

TEST(GridSheet, IsNoLargerThanAPdfCanBe) {
  EXPECT_NO_THROW(grid_sheet({9, 6, 461.8}));  // 11 squares: 5079.8 mm
  EXPECT_EQ(refusal_of({9, 6, 462}),
            "square_mm = 462: the page must be at most 5080 mm wide and high, not 5082 x 3706");
  EXPECT_THAT(refusal_of({6, 9, 462}), HasSubstr("not 3696 x 5092"));
}

TEST(GridSheet, IsRefusedWithAllProblemsOfItsShape) {
  const GridShape wrong{2, 101, kNan};
  const std::string all =
      "columns = 2: must be 3..100 inner corners\nrows = 101: must be 3..100 inner corners\n"
      "square_mm = nan: must be 1..1000";
  EXPECT_EQ(refusal_of(wrong), all);
  EXPECT_EQ(test::message_of([&wrong] { grid_sheet_pdf(wrong); }), all);
  EXPECT_EQ(test::message_of([&wrong] { grid_sheet_svg(wrong); }), all);
}

TEST(GridSheetSvg, HasTheSizeOfThePageAndTheSmallPrint) {
  const std::string svg = grid_sheet_svg({9, 6, 25});
  EXPECT_THAT(svg, HasSubstr("width=\"297mm\" height=\"210mm\" viewBox=\"0 0 297 210\""));
  EXPECT_THAT(svg, HasSubstr(">100 mm</text>"));
  EXPECT_THAT(svg, HasSubstr(">9x6 inner corners, squares of 25 mm: print at 100 %</text>"));
  EXPECT_THAT(grid_sheet_svg({9, 6, 50.5}), HasSubstr("width=\"555.5mm\" height=\"414mm\""));
}

TEST(GridSheetSvg, HasEverySecondSquareAtItsPlace) {
  for (const double square_mm : {25.0, 24.7}) {
    const GridShape shape{9, 6, square_mm};
    const GridSheet sheet = grid_sheet(shape);
    std::set<std::pair<int, int>> found;
    for (const auto& square : elements_of(grid_sheet_svg(shape), "rect", {"x", "y", "width", "height"})) {
      const auto column = std::lround((square[0] - sheet.board_left_mm) / square_mm);
      const auto row = std::lround((square[1] - sheet.board_top_mm) / square_mm);
      found.insert({static_cast<int>(column), static_cast<int>(row)});
      EXPECT_NEAR(square[0], sheet.board_left_mm + static_cast<double>(column) * square_mm, 1e-6);
      EXPECT_NEAR(square[1], sheet.board_top_mm + static_cast<double>(row) * square_mm, 1e-6);
      EXPECT_NEAR(square[2], square_mm, 1e-6);
      EXPECT_NEAR(square[3], square_mm, 1e-6);
    }
    std::set<std::pair<int, int>> expected;
    for (int row = 0; row < 7; ++row) {
      for (int column = 0; column < 10; ++column) {
        if ((column + row) % 2 == 0) expected.insert({column, row});
      }
    }
    EXPECT_EQ(expected.size(), 35U);
    EXPECT_EQ(found, expected);
  }
}

TEST(GridSheetSvg, HasARulerOf100MmBetweenTheBoardAndTheEdge) {
  const auto lines = elements_of(grid_sheet_svg({9, 6, 25}), "line", {"x1", "y1", "x2", "y2"});
  ASSERT_EQ(lines.size(), 1U + 11U);
  EXPECT_THAT(lines[0], ElementsAre(49.5, 205, 149.5, 205));
  for (std::size_t tick = 1; tick < lines.size(); ++tick) {
    EXPECT_DOUBLE_EQ(lines[tick][0], 49.5 + 10 * static_cast<double>(tick - 1));
    EXPECT_DOUBLE_EQ(lines[tick][2], lines[tick][0]);
    EXPECT_GT(lines[tick][3], 210 - 10);  // half a square is white below the board
  }
}

TEST(GridSheetPdf, HasTheSizeOfThePageAndATitleButNoDate) {
  const std::string pdf = grid_sheet_pdf({9, 6, 50});
  EXPECT_THAT(pdf, StartsWith("%PDF-"));
  EXPECT_THAT(pdf, HasSubstr("9x6 inner corners, squares of 50 mm"));
  EXPECT_THAT(pdf, Not(HasSubstr("Date")));
  const std::array<double, 4> box = media_box(pdf);
  EXPECT_EQ(box[0], 0);
  EXPECT_EQ(box[1], 0);
  EXPECT_NEAR(box[2], 550 / 25.4 * 72, 0.01);
  EXPECT_NEAR(box[3], 410 / 25.4 * 72, 0.01);
}

}  // namespace
}  // namespace stereotlm::calib
