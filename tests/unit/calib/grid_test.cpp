#include "calib/grid.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "calib/grid_sheet.h"
#include "calib/synthetic_rig.h"

namespace stereotlm::calib {
namespace {

double largest_distance(const Corners& a, const Corners& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

TEST(Grid, IsFoundToAFractionOfAPixel) {
  const SyntheticRig rig(1, 320, 240);
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
}

// OpenCV takes some part of a larger board for the whole.
TEST(Grid, OfMoreCornersIsRefused) {
  const kernels::GrayImage board = grid_sheet_image({9, 6, 25}, 2);
  EXPECT_TRUE(find_grid(board, {9, 6, 25}).corners);
  std::size_t refused = 0;
  for (const GridShape& part :
       {GridShape{8, 6, 25}, GridShape{9, 5, 25}, GridShape{8, 5, 25}, GridShape{7, 6, 25}}) {
    const GridSearch found = find_grid(board, part);
    EXPECT_FALSE(found.corners) << part.columns << 'x' << part.rows;
    if (found.problem.find("more than") != std::string::npos) ++refused;
  }
  EXPECT_GT(refused, 0U);
}

TEST(OrderedLike, TurnsCornersByHalf) {
  const GridShape shape = {3, 4, 1};
  Corners corners;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 3; ++column) corners.emplace_back(10 * column + row, 10 * row - column);
  }
  const Corners turned(corners.rbegin(), corners.rend());
  EXPECT_EQ(ordered_like(corners, shape, turned), corners);
  EXPECT_EQ(ordered_like(corners, shape, corners), corners);
}

TEST(OrderedLike, TurnsCornersOfASquareBoardByQuarters) {
  const GridShape shape = {3, 3, 1};
  Corners corners;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) corners.emplace_back(10 * column, 10 * row);
  }
  Corners turned;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) turned.emplace_back(20 - 10 * row, 10 * column);
  }
  EXPECT_EQ(ordered_like(corners, shape, turned), corners);
  EXPECT_EQ(ordered_like(corners, shape, Corners(turned.rbegin(), turned.rend())), corners);
}

}  // namespace
}  // namespace stereotlm::calib
