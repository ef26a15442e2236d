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

std::vector<int> with_invalid_as_minus_1(const GrayImage& image) {
  std::vector<int> values;
  for (const std::uint8_t pixel : image.pixels) values.push_back(pixel == kInvalidDisparity ? -1 : pixel);
  return values;
}

void expect_reference(const RandomBoard& board) {
  const auto expected = test::compute_reference(test::reference_input(board, 0));
  const GrayImage left = test::gray_image(board, expected.filtered_left);
  const GrayImage right = test::gray_image(board, expected.filtered_right);
  const test::Matches matches =
      test::match(left, right, board.window, board.disparities, test::matching_cost(board.cost));
  EXPECT_EQ(with_invalid_as_minus_1(matches.right_based), expected.right_based);
  EXPECT_EQ(with_invalid_as_minus_1(matches.left_based), expected.left_based);
  if (board.filter) {
    const GrayImage rectified = test::gray_image(board, expected.rectified_left);
    EXPECT_EQ(test::filter_image(rectified, *test::filter_kernel(board.filter)).pixels,
              expected.filtered_left);
  }
  EXPECT_EQ(test::disparity_image(board).pixels, expected.disparity);
}

// The pixels of a pair in four contents: constant, largest sums, extreme noise, a period of three columns.
std::uint8_t pixel_of(int content, bool left, int column, int row, test::SplitMix64& random) {
  if (content == 0) return 77;
  if (content == 1) return left ? 255 : 0;
  if (content == 2) return random.chance(50) ? 255 : 0;
  return static_cast<std::uint8_t>(60 * ((column + (left ? 0 : 1)) % 3) + row);
}

// Image sizes lie on both sides of the window, disparities on both sides of the image's width, and many sums
// are equal.
TEST(Stereo, EqualsTheReferenceForEachWindowAndContent) {
  test::SplitMix64 random(3);
  int next = 0;
  for (int window = 3; window <= 31; window += 2) {
    for (int content = 0; content < 4; ++content) {
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
          board.cost = test::any_cost(next / 5 + next);
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
  EXPECT_EQ(found(7, 0, 0), Problems{"disparities = 0: must be 1..254"});
  EXPECT_EQ(found(7, 255, 0), Problems{"disparities = 255: must be 1..254"});
  EXPECT_EQ(found(7, 80, -1), Problems{"lr_tolerance = -1: must be 0..253"});
  EXPECT_EQ(found(7, 80, 254), Problems{"lr_tolerance = 254: must be 0..253"});
  StereoConfig config;
  config.filter->shift = 32;
  EXPECT_EQ(problems(config), Problems{"filter: shift = 32: must be 0..31"});
  EXPECT_EQ(found(1, 0, -1).size(), 3U);
  config = {};
  config.cost = {CostKind::kCensus, 4};
  EXPECT_EQ(problems(config), Problems{"cost: census_size = 4: must be 3..7, odd"});
}

TEST(Stereo, RefusesDifferentSizesAndBrokenRules) {
  const GrayImage image(8, 5);
  const RectificationTable table = identity_table(8, 5);
  const StereoConfig config;
  EXPECT_NO_THROW(disparity_image(image, image, &table, &table, config));
  EXPECT_THROW(disparity_image(image, GrayImage(8, 4), nullptr, nullptr, config), std::invalid_argument);
  EXPECT_THROW(disparity_image(GrayImage(4, 5), image, nullptr, nullptr, config), std::invalid_argument);
  EXPECT_NO_THROW(test::match(image, image, 3, 254));
  EXPECT_THROW(test::match(image, image, 3, 2, {CostKind::kCensus, 9}), std::invalid_argument);
  EXPECT_THROW(test::match(image, image, 3, 2, {CostKind::kSsd, 3}), std::invalid_argument);
  for (const auto& [window, disparities] :
       {std::pair(1, 2), std::pair(4, 2), std::pair(33, 2), std::pair(3, 0), std::pair(3, 255)})
    EXPECT_THROW(test::match(image, image, window, disparities), std::invalid_argument);
  RectificationTable broken = table;
  broken.entries[3] = make_entry(8, 0);
  for (const RectificationTable& bad : {identity_table(8, 4), broken}) {
    EXPECT_THROW(disparity_image(image, image, &bad, &table, config), std::invalid_argument);
    EXPECT_THROW(disparity_image(image, image, &table, &bad, config), std::invalid_argument);
  }
  EXPECT_THROW(disparity_image(image, image, nullptr, nullptr, {1, 80, log7(), 0}), std::invalid_argument);
  FilterKernel kernel = log7();
  kernel.size = 5;
  EXPECT_THROW(test::filter_image(image, kernel), std::invalid_argument);
  EXPECT_THROW(test::filter_image(GrayImage(), log7()), std::invalid_argument);
  EXPECT_EQ(test::filter_image(GrayImage(1, 1, 7), log7()), GrayImage(1, 1, 128));
}

}  // namespace
}  // namespace stereotlm::kernels
