#include "calib/grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "calib/calibrate.h"
#include "sw/media/synthetic_rig.h"

namespace stereotlm::calib {
namespace {

double largest_distance(const Corners& a, const Corners& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

TEST(Grid, IsFoundToAFractionOfAPixel) {
  const media::SyntheticRig rig(1, 320, 240);
  const GridShape shape = {9, 6, 25};
  const auto pictures = rig.grid_view(shape, 0);
  const auto expected = rig.grid_corners(shape, 0);
  const GridSearch left = find_grid(pictures.left, shape);
  const GridSearch right = find_grid(pictures.right, shape);
  ASSERT_TRUE(left.corners) << left.problem;
  ASSERT_TRUE(right.corners) << right.problem;
  EXPECT_LT(largest_distance(ordered_like(expected.left, shape, *left.corners), expected.left), 0.15);
  EXPECT_LT(largest_distance(ordered_like(*left.corners, shape, *right.corners),
                             ordered_like(*left.corners, shape, expected.right)),
            0.15);
}

TEST(Grid, IsNotFoundWhereThereIsNone) {
  const GridSearch found = find_grid(kernels::GrayImage(64, 48, 128), {9, 6, 25});
  EXPECT_FALSE(found.corners);
  EXPECT_EQ(found.problem, "no grid of 9x6 inner corners found");
  for (const auto& [width, height] :
       {std::pair(4, 1), std::pair(640, 10), std::pair(4, 480), std::pair(16, 16)}) {
    EXPECT_FALSE(find_grid(kernels::GrayImage(width, height, 128), {9, 6, 25}).corners)
        << width << 'x' << height;
  }
}

// The corners of some columns and rows of the board.
Corners part_of(const GridShape& shape, const Corners& corners, const std::vector<int>& columns,
                const std::vector<int>& rows) {
  Corners part;
  for (const int row : rows) {
    for (const int column : columns)
      part.push_back(corners[static_cast<std::size_t>(row * shape.columns + column)]);
  }
  return part;
}

TEST(Grid, IsRefusedIfOnlyAPartWasFound) {
  const media::SyntheticRig rig(1, 320, 240);
  const GridShape shape = {9, 6, 25};
  const std::vector<int> all_columns = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  const std::vector<int> all_rows = {0, 1, 2, 3, 4, 5};
  for (int number = 0; number < 3; ++number) {
    const kernels::GrayImage picture = rig.grid_view(shape, number).left;
    const Corners corners = rig.grid_corners(shape, number).left;
    const auto is_whole = [&](const std::vector<int>& columns, const std::vector<int>& rows) {
      const GridShape part = {static_cast<int>(columns.size()), static_cast<int>(rows.size()), 25};
      return are_all_of_board(picture, part, part_of(shape, corners, columns, rows));
    };
    EXPECT_TRUE(is_whole(all_columns, all_rows)) << number;
    EXPECT_FALSE(is_whole({1, 2, 3, 4, 5, 6, 7, 8}, all_rows)) << number;
    EXPECT_FALSE(is_whole({0, 1, 2, 3, 4, 5, 6, 7}, all_rows)) << number;
    EXPECT_FALSE(is_whole({0, 1, 2, 3, 5, 6, 7, 8}, all_rows)) << number;
    EXPECT_FALSE(is_whole(all_columns, {1, 2, 3, 4, 5})) << number;
    EXPECT_FALSE(is_whole(all_columns, {0, 1, 2, 3, 4})) << number;
    EXPECT_FALSE(is_whole({1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4})) << number;
  }
}

TEST(OrderedLike, TurnsCornersByHalfAndThoseOfASquareBoardByQuarters) {
  for (const int rows : {3, 4}) {
    const GridShape shape = {3, rows, 1};
    Corners corners;
    Corners quarter_turned;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < 3; ++column) {
        corners.emplace_back(10 * column, 10 * row);
        quarter_turned.emplace_back(20 - 10 * row, 10 * column);
      }
    }
    const auto half_turned = [](const Corners& some) { return Corners(some.rbegin(), some.rend()); };
    EXPECT_EQ(ordered_like(corners, shape, corners), corners);
    EXPECT_EQ(ordered_like(corners, shape, half_turned(corners)), corners);
    if (rows != 3) continue;
    EXPECT_EQ(ordered_like(corners, shape, quarter_turned), corners);
    EXPECT_EQ(ordered_like(corners, shape, half_turned(quarter_turned)), corners);
  }
}

// A picture whose column x is column x + shift of a texture that repeats after `period` columns and rows.
kernels::GrayImage texture(int shift, int period) {
  std::mt19937 random(1);
  std::vector<std::uint8_t> tile(static_cast<std::size_t>(period * period));
  for (std::uint8_t& each : tile) each = static_cast<std::uint8_t>(random() % 2 * 200);
  kernels::GrayImage picture(200, 120);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const int place = (x + shift) / 4 % period + y / 4 % period * period;
      picture.at(x, y) = tile[static_cast<std::size_t>(place)];
    }
  }
  return picture;
}

TEST(MatchedRows, CountOnlyPointsThatAreAtOnePlace) {
  const MatchedRows rows = matched_rows(texture(0, 97), texture(12, 97), 40);
  EXPECT_GT(rows.in_row, 20U);
  EXPECT_EQ(rows.in_row, rows.error.corners);
  EXPECT_LT(rows.error.max_px, 0.3);
  const MatchedRows exchanged = matched_rows(texture(12, 97), texture(0, 97), 40);
  EXPECT_GT(exchanged.points, 20U);
  EXPECT_EQ(exchanged.in_row, 0U);
  for (const int shift : {0, 12}) EXPECT_EQ(matched_rows(texture(0, 5), texture(shift, 5), 40).points, 0U);
}

TEST(MatchedRows, RefusePicturesOfDifferentSizes) {
  EXPECT_THROW(matched_rows(kernels::GrayImage(32, 32), kernels::GrayImage(32, 28), 8),
               std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::calib
