#include "models/kernels/correlation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "models/kernels/stereo_pipeline.h"
#include "tests/support/random_board.h"
#include "tests/support/reference_arithmetic.h"
#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

constexpr std::int64_t kLargest = (std::int64_t{1} << 34) - 1;

TEST(Correlation, ComparesAsFractionsUpToTheLargestOnes) {
  // In ascending order.
  const std::vector<Correlation> values = {{-kLargest, 1},
                                           {-kLargest, kLargest - 1},
                                           {-kLargest, kLargest},
                                           {-2, 5},
                                           {-1, 2},
                                           {-1, kLargest},
                                           {0, 1},
                                           {1, kLargest},
                                           {1, kLargest - 1},
                                           {1, 2},
                                           {2, 5},
                                           {kLargest, kLargest},
                                           {kLargest, kLargest - 1},
                                           {kLargest, 1}};
  for (std::size_t a = 0; a < values.size(); ++a) {
    for (std::size_t b = 0; b < values.size(); ++b)
      EXPECT_EQ(is_greater(values[a], values[b]), a > b) << a << ", " << b;
  }
}

TEST(Correlation, OfEqualFractionsNoneIsGreater) {
  for (const auto& [a, b] :
       {std::pair(Correlation{2, 4}, Correlation{3, 9}), std::pair(Correlation{-2, 4}, Correlation{-3, 9}),
        std::pair(Correlation{0, 4}, Correlation{0, 9})}) {
    EXPECT_FALSE(is_greater(a, b));
    EXPECT_FALSE(is_greater(b, a));
  }
}

TEST(PixelSums, HaveAVarianceOfOneWhereAllPixelsAreEqual) {
  EXPECT_EQ((PixelSums{9 * 77, 9 * 77 * 77}.variance(9)), 1);
  EXPECT_EQ((PixelSums{3, 3}.variance(9)), 9 * 3 - 3 * 3);
}

// The left image holds the right window several times, with one pixel brighter by 0, 1 or 2: the scores are
// equal, or differ by some millionths. `order`: the brightness of the copies, in the order of their columns.
void expect_near_tie(const std::vector<int>& order, int window, test::SplitMix64& random) {
  const int width = (static_cast<int>(order.size()) * window + 3) / 4 * 4;
  test::RandomBoard board = test::noise_board(width, window, window, random);
  board.cost.kind = test::ReferenceCost::Kind::kZncc;
  board.disparities = std::min(254, width);
  auto& left = board.pictures[0].left;
  const auto& right = board.pictures[0].right;
  const auto at = [width](int column, int row) { return static_cast<std::size_t>(row * width + column); };
  for (std::size_t copy = 0; copy < order.size(); ++copy) {
    const int first = static_cast<int>(copy) * window;
    for (int row = 0; row < window; ++row) {
      for (int column = 0; column < window; ++column) left[at(first + column, row)] = right[at(column, row)];
    }
    auto& pixel = left[at(first + window / 2, window / 2)];
    pixel = static_cast<std::uint8_t>(pixel % 250 + order[copy]);
  }
  const auto expected = test::compute_reference(test::reference_input(board, 0));
  for (const Simd* simd : simd_sets()) {
    StereoPipeline pipeline(width, window, test::stereo_config(board), *simd);
    std::vector<std::uint8_t> found(left.size());
    pipeline.run(left.data(), right.data(), nullptr, nullptr, found.data());
    ASSERT_EQ(found, expected.disparity) << simd->name;
  }
}

TEST(ImageMatcher, DecidesNearTiesOfCorrelationsExactly) {
  test::SplitMix64 random(31);
  for (const int window : {3, 7, 19, 21, 31}) {
    for (int round = 0; round < 6; ++round) {
      for (const auto& order :
           std::vector<std::vector<int>>{{0, 1, 2}, {2, 1, 0}, {1, 1, 1}, {1, 0, 1}, {2, 0, 0}})
        ASSERT_NO_FATAL_FAILURE(expect_near_tie(order, window, random)) << window;
    }
  }
}

}  // namespace
}  // namespace stereotlm::kernels
