#include "models/kernels/cost_columns.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "models/kernels/column_scores.h"
#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

class CostColumnsOf : public testing::TestWithParam<int> {
 protected:
  MatchingCost cost_ = test::matching_cost(test::any_cost(GetParam()));
};

INSTANTIATE_TEST_SUITE_P(EachCost, CostColumnsOf, testing::Range(0, test::kCosts), [](const auto& suite) {
  const test::ReferenceCost cost = test::any_cost(suite.param);
  return std::string(name_of(test::matching_cost(cost).kind)) + std::to_string(cost.census_size);
});

TEST_P(CostColumnsOf, HoldTheLargestSum) {
  CostColumns sums(31, 254, cost_);
  const std::vector<std::uint8_t> white(31 * 6, 255);
  const std::vector<std::uint8_t> black(31 * 6, 0);
  const auto& left = cost_.kind == CostKind::kZncc ? white : black;
  for (int column = 0; column < 300; ++column) sums.push_column(left.data(), white.data());
  int largest = 255;
  if (cost_.kind == CostKind::kSsd || cost_.kind == CostKind::kZncc) largest = 255 * 255;
  if (cost_.kind == CostKind::kCensus) largest = 8 * cost_.pixel_bytes();
  for (int d = 0; d < 254; ++d) ASSERT_EQ(sums.window_sums()[d], 31 * 31 * largest);
}

// The random boards compare what is found with the sums. A key has 23 bits for the sum.
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
