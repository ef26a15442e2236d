#include "calib/grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "calib/calibrate.h"
#include "calib/opencv_conversions.h"
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

// A picture mirrored, then turned clockwise by `quarters` of 90 degrees.
struct Turn {
  bool is_mirrored;
  int quarters;

  kernels::GrayImage of(const kernels::GrayImage& image) const {
    cv::Mat turned = view(image).clone();
    if (is_mirrored) cv::flip(turned, turned, 1);
    for (int i = 0; i < quarters; ++i) cv::rotate(turned, turned, cv::ROTATE_90_CLOCKWISE);
    kernels::GrayImage result(turned.cols, turned.rows);
    result.pixels.assign(turned.begin<std::uint8_t>(), turned.end<std::uint8_t>());
    return result;
  }

  // Of a position in a picture of this size.
  Eigen::Vector2d of(Eigen::Vector2d position, int width, int height) const {
    if (is_mirrored) position.x() = width - 1 - position.x();
    for (int i = 0; i < quarters; ++i, std::swap(width, height))
      position = Eigen::Vector2d(height - 1 - position.y(), position.x());
    return position;
  }
};

const std::vector<GridShape> kOfEachPattern = {{9, 6, 25},
                                               {6, 6, 25},
                                               {9, 6, 25, Pattern::kCircles},
                                               {5, 5, 25, Pattern::kCircles},
                                               {4, 11, 15, Pattern::kAsymmetricCircles},
                                               {5, 5, 15, Pattern::kAsymmetricCircles}};

// Each corner is one of the grid, the sense of rotation is the same, and asymmetric circles are in the only
// order that they have.
TEST(Grid, IsFoundInAnyDirectionWithTheSameSenseOfRotation) {
  const media::SyntheticRig rig(4, 480, 360);
  for (const GridShape& shape : kOfEachPattern) {
    const kernels::GrayImage picture = rig.grid_view(shape, 1).left;
    const Corners expected = rig.grid_corners(shape, 1).left;
    for (int i = 0; i < 8; ++i) {
      const Turn turn = {i >= 4, i % 4};
      const GridSearch found = find_grid(turn.of(picture), shape);
      ASSERT_TRUE(found.corners) << shape.text() << ' ' << i << ": " << found.problem;
      const Corners& corners = *found.corners;
      const auto last = static_cast<std::size_t>(shape.columns) - 1;
      const Eigen::Vector2d right = corners[last] - corners.front();
      const Eigen::Vector2d down = corners[corners.size() - 1 - last] - corners.front();
      EXPECT_GT(right.x() * down.y() - right.y() * down.x(), 0) << shape.text() << ' ' << i;
      const bool has_one_order = shape.pattern == Pattern::kAsymmetricCircles && !turn.is_mirrored;
      for (std::size_t corner = 0; corner < corners.size(); ++corner) {
        const Eigen::Vector2d seen = turn.of(expected[corner], picture.width, picture.height);
        double nearest = (corners[corner] - seen).norm();
        for (const Eigen::Vector2d& other : corners) {
          if (!has_one_order) nearest = std::min(nearest, (other - seen).norm());
        }
        EXPECT_LT(nearest, 0.2) << shape.text() << ' ' << i << ' ' << corner;
      }
    }
  }
}

TEST(Grid, IsNotFoundIfItHasMoreOrFewerCorners) {
  const media::SyntheticRig rig(4, 480, 360);
  for (const GridShape& shape : kOfEachPattern) {
    const kernels::GrayImage picture = rig.grid_view(shape, 1).left;
    const int step = shape.pattern == Pattern::kAsymmetricCircles ? 2 : 1;  // of rows: an odd number
    for (const auto& [columns, rows] :
         {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
      const GridShape other = {shape.columns + columns, shape.rows + step * rows, 25, shape.pattern};
      EXPECT_FALSE(find_grid(picture, other).corners) << shape.text() << " as " << other.text();
    }
  }
}

kernels::GrayImage with_grain(kernels::GrayImage image, double deviation) {
  std::mt19937 random(1);
  for (std::uint8_t& pixel : image.pixels) {
    double sum = -6;  // of twelve numbers 0..1: nearly normal, with deviation 1
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) / 4294967296.0;
    pixel = static_cast<std::uint8_t>(std::clamp(pixel + deviation * sum, 0.0, 255.0));
  }
  return image;
}

// The first detector finds none of these, and the search with adaptive thresholds took 150 s.
TEST(Grid, IsFoundUnderStrongGrain) {
  const media::SyntheticRig rig(1, 640, 480);
  const GridShape shape = {9, 6, 25};
  for (int number = 0; number < 2; ++number) {
    const kernels::GrayImage picture = with_grain(rig.grid_view(shape, number).left, 40);
    const GridSearch found = find_grid(picture, shape);
    ASSERT_TRUE(found.corners) << number << ": " << found.problem;
    const Corners expected = rig.grid_corners(shape, number).left;
    EXPECT_LT(largest_distance(ordered_like(expected, shape, *found.corners), expected), 1) << number;
    EXPECT_FALSE(find_grid(picture, {10, 6, 25}).corners) << number;
  }
}

// A large picture is reduced for the search, which must not shift the corners.
TEST(Grid, IsFoundAtTheSamePlaceInALargePicture) {
  constexpr int kFactor = 4;
  const media::SyntheticRig rig(4, 480, 360);
  for (const GridShape& shape : {kOfEachPattern[0], kOfEachPattern[2]}) {
    const kernels::GrayImage picture = rig.grid_view(shape, 1).left;
    kernels::GrayImage large(kFactor * picture.width, kFactor * picture.height);
    for (int row = 0; row < large.height; ++row) {
      for (int column = 0; column < large.width; ++column)
        large.at(column, row) = picture.at(column / kFactor, row / kFactor);
    }
    const GridSearch expected = find_grid(picture, shape);
    const GridSearch found = find_grid(large, shape);
    ASSERT_TRUE(expected.corners && found.corners) << shape.text();
    Eigen::Vector2d shift(0, 0);
    for (std::size_t i = 0; i < found.corners->size(); ++i)
      shift += (*found.corners)[i] - (kFactor * ((*expected.corners)[i].array() + 0.5) - 0.5).matrix();
    EXPECT_LT(shift.norm() / static_cast<double>(found.corners->size()), 0.1) << shape.text();
  }
}

TEST(Grid, IsNotLookedForAmongTooManyDots) {
  kernels::GrayImage picture(640, 480, 220);
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      if (std::hypot(column % 20 - 10, row % 20 - 10) < 6) picture.at(column, row) = 30;
    }
  }
  EXPECT_EQ(find_grid(picture, {4, 11, 15, Pattern::kAsymmetricCircles}).problem,
            "768 dark dots: must be 400 at most, to find a grid of 4x11 circles among them");
}

TEST(GridShape, AsymmetricCirclesAreThoseOfOpenCV) {
  const GridShape shape = {3, 3, 10, Pattern::kAsymmetricCircles};
  const std::vector<Eigen::Vector3d> expected = {{0, 0, 0},   {20, 0, 0},  {40, 0, 0},
                                                 {10, 10, 0}, {30, 10, 0}, {50, 10, 0},
                                                 {0, 20, 0},  {20, 20, 0}, {40, 20, 0}};
  EXPECT_EQ(corner_points(shape), expected);
  EXPECT_EQ(shape.extent(), Eigen::Vector2d(5, 2));
  EXPECT_TRUE(problems(shape).empty());
  const std::vector<std::string> even = problems({3, 4, 10, Pattern::kAsymmetricCircles});
  ASSERT_EQ(even.size(), 1U);
  EXPECT_EQ(even.front().find("rows = 4: must be odd with asymmetric circles"), 0U);
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
