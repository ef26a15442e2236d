#include "models/kernels/cost_columns.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "models/kernels/column_scores.h"
#include "tests/support/random_board.h"
#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

using PixelColumns = std::vector<std::vector<std::uint8_t>>;

PixelColumns random_columns(int columns, int window, bool extreme, test::SplitMix64& random) {
  PixelColumns pixels(static_cast<std::size_t>(columns));
  for (auto& column : pixels) {
    for (int row = 0; row < window; ++row) {
      const int value = extreme ? 255 * random.between(0, 1) : random.between(0, 255);
      column.push_back(static_cast<std::uint8_t>(value));
    }
  }
  return pixels;
}

int cost_of(CostKind kind, int right, int left) {
  switch (kind) {
    case CostKind::kSad:
      return std::abs(right - left);
    case CostKind::kSsd:
      return (right - left) * (right - left);
    case CostKind::kZncc:
      return right * left;
    case CostKind::kCensus:
      break;
  }
  int bits = 0;
  for (int differing = right ^ left; differing != 0; differing &= differing - 1) ++bits;
  return bits;
}

// Sum of the costs of the right pixels d columns before and the left pixels, over the window columns that end
// at `column`.
int window_sum(CostKind kind, const PixelColumns& left, const PixelColumns& right, int column, int d,
               int window) {
  int sum = 0;
  for (int c = column - window + 1; c <= column; ++c) {
    const auto& left_column = left[static_cast<std::size_t>(c)];
    const auto& right_column = right[static_cast<std::size_t>(c - d)];
    for (std::size_t row = 0; row < left_column.size(); ++row)
      sum += cost_of(kind, right_column[row], left_column[row]);
  }
  return sum;
}

// One frame through modules of each instruction set. A frame before it must leave no trace.
void expect_literal_sums(std::vector<CostColumns>& sets, const MatchingCost& cost, int window,
                         int disparities, bool extreme, int columns, test::SplitMix64& random) {
  SCOPED_TRACE("window " + std::to_string(window) + ", disparities " + std::to_string(disparities));
  const PixelColumns left = random_columns(columns, window * cost.pixel_bytes(), extreme, random);
  const PixelColumns right = random_columns(columns, window * cost.pixel_bytes(), extreme, random);
  for (CostColumns& sums : sets) {
    sums.start_frame();
    ASSERT_GE(sums.lanes(), disparities);
  }
  for (int column = 0; column < columns; ++column) {
    const auto at = static_cast<std::size_t>(column);
    for (CostColumns& sums : sets) sums.push_column(left[at].data(), right[at].data());
    for (int d = 0; d < disparities && d <= column - window + 1; ++d) {
      const int expected = window_sum(cost.kind, left, right, column, d, window);
      for (std::size_t set = 0; set < sets.size(); ++set)
        ASSERT_EQ(sets[set].window_sums()[d], expected)
            << simd_sets()[set]->name << ", d " << d << ", " << column;
    }
  }
}

std::vector<CostColumns> with_each_instruction_set(int window, int disparities, const MatchingCost& cost) {
  std::vector<CostColumns> sets;
  for (const Simd* simd : simd_sets()) sets.emplace_back(window, disparities, cost, *simd);
  return sets;
}

class CostColumnsOf : public testing::TestWithParam<int> {
 protected:
  MatchingCost cost_ = test::matching_cost(test::any_cost(GetParam()));
};

INSTANTIATE_TEST_SUITE_P(EachCost, CostColumnsOf, testing::Range(0, test::kCosts), [](const auto& suite) {
  const test::ReferenceCost cost = test::any_cost(suite.param);
  return std::string(name_of(test::matching_cost(cost).kind)) + std::to_string(cost.census_size);
});

TEST_P(CostColumnsOf, HoldTheLiteralSumsOfEachCandidateWithEachInstructionSet) {
  test::SplitMix64 random(1);
  const auto expect_frames = [&](int window, int disparities, int columns) {
    auto sets = with_each_instruction_set(window, disparities, cost_);
    for (const bool extreme : {false, true})
      expect_literal_sums(sets, cost_, window, disparities, extreme, columns, random);
  };
  for (const int disparities : {1, 31, 32, 33, 64, 254}) expect_frames(3, disparities, disparities + 20);
  expect_frames(7, 80, 120);
  expect_frames(31, 33, 80);
  expect_frames(3, 17, 1100);  // more columns than the histories hold
}

TEST_P(CostColumnsOf, HoldTheLargestSum) {
  CostColumns sums(31, 254, cost_);
  const std::vector<std::uint8_t> white(31 * 6, 255);
  const std::vector<std::uint8_t> black(31 * 6, 0);
  const auto& left = cost_.kind == CostKind::kZncc ? white : black;
  for (int column = 0; column < 300; ++column) sums.push_column(left.data(), white.data());
  const int largest = cost_.pixel_bytes() * cost_of(cost_.kind, 255, left.front());
  for (int d = 0; d < 254; ++d) ASSERT_EQ(sums.window_sums()[d], 31 * 31 * largest);
}

// A key has 23 bits for the sum.
TEST(ColumnScorer, IsNeededForCorrelationsAndForSquaresOfLargeWindows) {
  for (int window = 3; window <= 31; window += 2) {
    EXPECT_FALSE(ColumnScorer::is_needed(window, {CostKind::kSad, 0}));
    EXPECT_FALSE(ColumnScorer::is_needed(window, {CostKind::kCensus, 7}));
    EXPECT_TRUE(ColumnScorer::is_needed(window, {CostKind::kZncc, 0}));
    EXPECT_EQ(ColumnScorer::is_needed(window, {CostKind::kSsd, 0}), window >= 13) << window;
  }
}

TEST(SimdArray, IsPaddedAlignedAndZero) {
  for (const auto& [lanes, padded] :
       {std::pair(1, 16), std::pair(16, 16), std::pair(17, 32), std::pair(254, 256)}) {
    EXPECT_EQ(padded_lanes(lanes), padded);
    SimdArray<std::int16_t> array(lanes);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % kMostFrameVectorBytes, 0U);
    for (int lane = 0; lane < padded; ++lane) EXPECT_EQ(array.data()[lane], 0);
  }
}

}  // namespace
}  // namespace stereotlm::kernels
