#include "models/kernels/correlation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "models/kernels/simd.h"
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

void expect_reference(const test::RandomBoard& board) {
  const auto expected = test::compute_reference(test::reference_input(board, 0));
  const auto& [left, right] = board.pictures[0];
  for (const Simd* simd : simd_sets()) {
    StereoPipeline pipeline(board.width, board.height, test::stereo_config(board), *simd);
    std::vector<std::uint8_t> found(left.size());
    pipeline.run(left.data(), right.data(), nullptr, nullptr, found.data());
    ASSERT_EQ(found, expected.disparity) << simd->name;
  }
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
  expect_reference(board);
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

// Pictures whose windows have many equal scores, by what makes them equal.
enum class Content {
  kPeriod,        // equal windows
  kGains,         // rows of stripes, with steps of brightness: proportional windows
  kPowers,        // rows of stripes that double their brightness in each column
  kInverse,       // the left picture is the negative of a periodic right one: scores below 0
  kPeriodInRows,  // periodic in some rows only
  kPeriodInParts  // periodic in some columns only
};
constexpr int kContents = 6;

std::uint8_t pixel_of(Content content, int period, int column, int row, bool left, test::SplitMix64& random) {
  const auto noise = [](int u, int v) { return (u * u * 37 + v * v * 101 + u * v * 59 + 11 * u) % 251; };
  const auto pixel = [&] {
    const int periodic = noise(column % period, row);
    switch (content) {
      case Content::kPeriod:
        return periodic;
      case Content::kGains:
        return row % 2 * (10 + column / (2 * period));
      case Content::kPowers:
        return row % 2 << (column + (left ? 0 : 3)) % 8;
      case Content::kInverse:
        return left ? 255 - periodic : periodic;
      case Content::kPeriodInRows:
        return row / 3 % 2 == 0 ? periodic : random.between(0, 255);
      case Content::kPeriodInParts:
        return column / 25 % 2 == 0 ? periodic : random.between(0, 255);
    }
    return 0;
  };
  return static_cast<std::uint8_t>(pixel());
}

TEST(ImageMatcher, DecidesEqualCorrelationsExactly) {
  test::SplitMix64 random(32);
  for (int content = 0; content < kContents; ++content) {
    for (const auto& [window, period, width, height, disparities] :
         {std::tuple(3, 2, 120, 12, 80), std::tuple(3, 5, 96, 30, 17), std::tuple(5, 16, 104, 11, 254),
          std::tuple(7, 3, 64, 14, 33), std::tuple(13, 4, 80, 20, 16), std::tuple(31, 6, 72, 34, 30)}) {
      test::RandomBoard board = test::noise_board(width, height, window, random);
      board.cost.kind = test::ReferenceCost::Kind::kZncc;
      board.disparities = disparities;
      board.lr_tolerance = random.between(0, 2);
      auto& [left, right] = board.pictures[0];
      for (int row = 0; row < height; ++row) {
        for (int column = 0; column < width; ++column) {
          const auto at = static_cast<std::size_t>(row * width + column);
          left[at] = pixel_of(Content{content}, period, column, row, true, random);
          right[at] = pixel_of(Content{content}, period, column, row, false, random);
        }
      }
      SCOPED_TRACE("content " + std::to_string(content) + ", window " + std::to_string(window));
      ASSERT_NO_FATAL_FAILURE(expect_reference(board));
    }
  }
}

// x^2 / (x^2 + 1) rises with x. Up to 2^17 two neighbours differ by 2^-50 of their value or more: as doubles
// many are equal.
TEST(Simd, FindsTheFirstOfTheGreatestScoresThatDoublesCannotDistinguish) {
  test::SplitMix64 random(33);
  constexpr int kLargestRoot = 131070;
  for (int round = 0; round < 3000; ++round) {
    const int count = random.between(1, 254);
    const int roots = random.between(1, 20);
    const bool negative = random.chance(30);
    SimdArray<std::int32_t> products(count);
    const auto padded = static_cast<std::size_t>(padded_lanes(count));
    const std::vector<double> sums(padded);
    std::vector<std::int64_t> variances(padded, 1);
    std::vector<double> inverses(padded, 1);
    std::vector<double> quotients(padded);
    int expected = 0;
    const auto score = [&](int c) {
      return Correlation{products.data()[c], variances[static_cast<std::size_t>(c)]};
    };
    for (int c = 0; c < static_cast<int>(padded); ++c) {
      const auto at = static_cast<std::size_t>(c);
      const int root = kLargestRoot - random.between(0, roots);
      products.data()[c] = negative ? -root : root;
      variances[at] = std::int64_t{root} * root + 1;
      inverses[at] = 1 / static_cast<double>(variances[at]);
      if (c > 0 && c < count && is_greater(score(c), score(expected))) expected = c;
    }
    const Candidates candidates{count, sums.data(), variances.data(), inverses.data()};
    for (const Simd* simd : simd_sets()) {
      ASSERT_EQ(simd->best_candidate(candidates, products.data(), 1, 0, quotients.data()), expected)
          << simd->name;
    }
  }
}

}  // namespace
}  // namespace stereotlm::kernels
