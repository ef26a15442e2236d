#include "models/kernels/stereo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "models/kernels/words.h"
#include "tests/support/random_board.h"
#include "tests/support/reference_arithmetic.h"
#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

using test::RandomBoard;
using Row = std::vector<int>;

constexpr int kX = kInvalidDisparity;

std::vector<int> with_invalid_as_minus_1(const GrayImage& image) {
  std::vector<int> values;
  for (const std::uint8_t pixel : image.pixels) values.push_back(pixel == kInvalidDisparity ? -1 : pixel);
  return values;
}

void expect_reference(const RandomBoard& board) {
  const auto expected = test::compute_reference(test::reference_input(board, 0));
  const GrayImage left = test::gray_image(board, expected.filtered_left);
  const GrayImage right = test::gray_image(board, expected.filtered_right);
  const Matches matches = match(left, right, board.window, board.disparities);
  EXPECT_EQ(with_invalid_as_minus_1(matches.right_based), expected.right_based);
  EXPECT_EQ(with_invalid_as_minus_1(matches.left_based), expected.left_based);
  if (board.filter) {
    const GrayImage rectified = test::gray_image(board, expected.rectified_left);
    EXPECT_EQ(filter_image(rectified, *test::filter_kernel(board.filter)).pixels, expected.filtered_left);
  }
  EXPECT_EQ(test::disparity_image(board).pixels, expected.disparity);
}

TEST(Stereo, EqualsTheReferenceOnRandomBoards) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const RandomBoard board = test::make_random_board(seed);
    SCOPED_TRACE(describe(board));
    ASSERT_NO_FATAL_FAILURE(expect_reference(board));
    if (HasFailure()) return;
  }
}

enum class Content { kConstant, kBlackAndWhite, kExtremeNoise, kPeriodic };

std::uint8_t pixel_of(Content content, bool left, int column, int row, test::SplitMix64& random) {
  switch (content) {
    case Content::kConstant:
      return 77;
    case Content::kBlackAndWhite:  // the largest sums
      return left ? 255 : 0;
    case Content::kExtremeNoise:
      return random.chance(50) ? 255 : 0;
    case Content::kPeriodic:
      break;
  }
  return static_cast<std::uint8_t>(60 * ((column + (left ? 0 : 1)) % 3) + row);
}

// Image sizes lie on both sides of the window, disparities on both sides of the image's width, and many sums
// are equal.
TEST(Stereo, EqualsTheReferenceForEachWindowAndContent) {
  test::SplitMix64 random(3);
  int next = 0;
  for (int window = 3; window <= 31; window += 2) {
    for (const auto content :
         {Content::kConstant, Content::kBlackAndWhite, Content::kExtremeNoise, Content::kPeriodic}) {
      for (const int width : {(window + 2) / 4 * 4, (window + 30) / 4 * 4}) {
        for (const int height : {window - 1, window, window + 2}) {
          RandomBoard board;
          board.width = std::max(4, width);
          board.height = height;
          board.window = window;
          const int disparities[] = {1, 2, board.width - 1, board.width, 254};
          board.disparities = disparities[next++ % 5];
          board.lr_tolerance = next % 3;
          if (next % 4 == 0) board.lr_tolerance.reset();
          board.frames = 1;
          board.pictures.resize(1);
          for (int row = 0; row < height; ++row) {
            for (int column = 0; column < board.width; ++column) {
              board.pictures[0].left.push_back(pixel_of(content, true, column, row, random));
              board.pictures[0].right.push_back(pixel_of(content, false, column, row, random));
            }
          }
          SCOPED_TRACE("window " + std::to_string(window) + ", disparities " +
                       std::to_string(board.disparities) + ", " + std::to_string(board.width) + " x " +
                       std::to_string(height));
          ASSERT_NO_FATAL_FAILURE(expect_reference(board));
          if (HasFailure()) return;
        }
      }
    }
  }
}

// The left rows are 0 10 20 10 0 .., the right rows begin two columns later: d = 2 and d = 6 have a sum of 0.
constexpr int kWidth = 12;

GrayImage stripes(int first) {
  constexpr std::uint8_t kPattern[] = {0, 10, 20, 10};
  GrayImage image(kWidth, 3);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < kWidth; ++column) image.at(column, row) = kPattern[(column + first) % 4];
  }
  return image;
}

Row middle_row(const GrayImage& image) {
  Row row;
  for (int column = 0; column < image.width; ++column) row.push_back(image.at(column, 1));
  return row;
}

TEST(Stereo, TakesTheSmallestDisparityOfATie) {
  const Matches matches = match(stripes(0), stripes(2), 3, 10);
  // At x = 2 the sums are 20 for d = 0 and 30 for d = 1.
  EXPECT_EQ(middle_row(matches.left_based), (Row{kX, 0, 0, 2, 2, 2, 2, 2, 2, 2, 2, kX}));
  // At x = 9 they are 40 and 30; left column 11 has no window.
  EXPECT_EQ(middle_row(matches.right_based), (Row{kX, 2, 2, 2, 2, 2, 2, 2, 2, 1, 0, kX}));
  for (int column = 0; column < kWidth; ++column) {
    EXPECT_EQ(matches.left_based.at(column, 0), kX);
    EXPECT_EQ(matches.right_based.at(column, 2), kX);
  }
}

TEST(Stereo, ChecksTheTwoSidesAgainstEachOther) {
  const auto row_with = [](std::optional<int> tolerance) {
    return middle_row(
        disparity_image(stripes(0), stripes(2), nullptr, nullptr, {3, 10, std::nullopt, tolerance}));
  };
  EXPECT_EQ(row_with(0), (Row{kX, kX, kX, 2, 2, 2, 2, 2, 2, 2, 2, kX}));
  EXPECT_EQ(row_with(1), row_with(0));
  EXPECT_EQ(row_with(2), (Row{kX, 0, 0, 2, 2, 2, 2, 2, 2, 2, 2, kX}));
  EXPECT_EQ(row_with(std::nullopt), row_with(2));
}

TEST(Stereo, HasNoDisparityWhereTheLeftTableHasNoEntry) {
  const GrayImage black(8, 5);
  RectificationTable left = identity_table(8, 5);
  RectificationTable right = identity_table(8, 5);
  left.entries[2 * 8 + 3] = 0;
  right.entries[2 * 8 + 5] = 0;  // has no effect: the pixel becomes 0, which it is already
  for (const std::optional<int> tolerance : {std::optional<int>(0), std::optional<int>()}) {
    const GrayImage image = disparity_image(black, black, &left, &right, {3, 4, log7(), tolerance});
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < 8; ++column) {
        const bool border = row == 0 || row == 4 || column == 0 || column == 7;
        const bool invalid = border || (column == 3 && row == 2);
        EXPECT_EQ(image.at(column, row), invalid ? kInvalidDisparity : 0) << column << ", " << row;
      }
    }
  }
}

TEST(Stereo, FiltersOneWhitePixelToItsKernel) {
  GrayImage image(9, 9);
  image.at(4, 4) = 255;
  const GrayImage filtered = filter_image(image, log7());
  EXPECT_EQ(filtered.at(4, 4), 255);  // 128 + 255 * 112 / 64
  EXPECT_EQ(filtered.at(5, 4), 255);  // 128 + floor(139.45)
  EXPECT_EQ(filtered.at(6, 4), 64);   // 128 + floor(-63.75)
  EXPECT_EQ(filtered.at(7, 4), 108);  // 128 + floor(-19.92)
  EXPECT_EQ(filtered.at(5, 5), 128);
  EXPECT_EQ(filtered.at(6, 5), 72);   // 128 + floor(-55.78)
  EXPECT_EQ(filtered.at(6, 6), 104);  // 128 + floor(-23.90)
  EXPECT_EQ(filtered.at(8, 8), 128);
}

TEST(Stereo, CorrelatesAndDoesNotMirrorTheKernel) {
  GrayImage image(8, 3);
  image.at(4, 1) = 10;
  const FilterKernel kernel{3, {0, 0, 0, -1, 0, 1, 0, 0, 0}, 0};
  const GrayImage filtered = filter_image(image, kernel);
  EXPECT_EQ(filtered.at(3, 1), 138);
  EXPECT_EQ(filtered.at(5, 1), 118);
}

TEST(Stereo, RepeatsTheEdgePixels) {
  GrayImage image(4, 1);
  image.pixels = {10, 20, 40, 80};
  const FilterKernel right_minus_left{3, {0, 0, 0, -1, 0, 1, 0, 0, 0}, 0};
  EXPECT_EQ(filter_image(image, right_minus_left).pixels, (std::vector<std::uint8_t>{138, 158, 188, 168}));
  const FilterKernel lower_minus_upper{3, {0, -1, 0, 0, 0, 0, 0, 1, 0}, 0};
  EXPECT_EQ(filter_image(image, lower_minus_upper).pixels, std::vector<std::uint8_t>(4, 128));
}

TEST(StereoConfig, NamesTheRuleThatItBreaks) {
  const auto found = [](int window, int disparities, std::optional<int> tolerance) {
    return problems(StereoConfig{window, disparities, log7(), tolerance});
  };
  using Problems = std::vector<std::string>;
  EXPECT_EQ(problems(StereoConfig{}), Problems());
  EXPECT_EQ(found(3, 1, 0), Problems());
  EXPECT_EQ(found(31, 254, 253), Problems());
  EXPECT_EQ(found(7, 80, std::nullopt), Problems());
  for (const int window : {1, 2, 4, 30, 32, 33})
    EXPECT_EQ(found(window, 80, 0), Problems{"window = " + std::to_string(window) + ": must be 3..31, odd"});
  for (const int disparities : {0, 255})
    EXPECT_EQ(found(7, disparities, 0),
              Problems{"disparities = " + std::to_string(disparities) + ": must be 1..254"});
  for (const int tolerance : {-1, 254})
    EXPECT_EQ(found(7, 80, tolerance),
              Problems{"lr_tolerance = " + std::to_string(tolerance) + ": must be 0..253"});
  StereoConfig config;
  config.filter->shift = 32;
  EXPECT_EQ(problems(config), Problems{"filter: shift = 32: must be 0..31"});
  EXPECT_EQ(found(1, 0, -1).size(), 3U);
}

TEST(Stereo, RefusesDifferentSizesAndBrokenRules) {
  const GrayImage image(8, 5);
  const RectificationTable table = identity_table(8, 5);
  const StereoConfig config;
  EXPECT_NO_THROW(disparity_image(image, image, &table, &table, config));
  EXPECT_THROW(disparity_image(image, GrayImage(8, 4), nullptr, nullptr, config), std::invalid_argument);
  EXPECT_THROW(disparity_image(GrayImage(4, 5), image, nullptr, nullptr, config), std::invalid_argument);
  EXPECT_NO_THROW(match(image, image, 3, 254));
  EXPECT_THROW(match(image, GrayImage(8, 4), 3, 2), std::invalid_argument);
  for (const auto& [window, disparities] :
       {std::pair(1, 2), std::pair(4, 2), std::pair(33, 2), std::pair(3, 0), std::pair(3, 255)})
    EXPECT_THROW(match(image, image, window, disparities), std::invalid_argument);
  RectificationTable broken = table;
  broken.entries[3] = make_entry(8, 0);
  for (const RectificationTable& bad : {identity_table(8, 4), broken}) {
    EXPECT_THROW(disparity_image(image, image, &bad, &table, config), std::invalid_argument);
    EXPECT_THROW(disparity_image(image, image, &table, &bad, config), std::invalid_argument);
  }
  EXPECT_THROW(disparity_image(image, image, nullptr, nullptr, {1, 80, log7(), 0}), std::invalid_argument);
  FilterKernel kernel = log7();
  kernel.size = 5;
  EXPECT_THROW(filter_image(image, kernel), std::invalid_argument);
  EXPECT_THROW(filter_image(GrayImage(), log7()), std::invalid_argument);
  EXPECT_EQ(filter_image(GrayImage(1, 1, 7), log7()), GrayImage(1, 1, 128));
}

}  // namespace
}  // namespace stereotlm::kernels
