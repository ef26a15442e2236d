#include "models/area/filter_arithmetic.h"

#include <gtest/gtest.h>

#include "tests/unit/area/resources.h"

namespace stereotlm::area {
namespace {

using kernels::FilterKernel;

FilterKernel laplacian(int weight) {
  return {3, {0, -weight, 0, -weight, 4 * weight, -weight, 0, -weight, 0}, 3};
}

// What every filter has beside its sums, and per unit of its half width what repeats the edges.
constexpr int kRest = 39;
constexpr int kEdges = 16;
constexpr int kRestFlipFlops = 77;

TEST(FilterArithmetic, IsTheSumOfItsAdders) {
  // Sums of 17 bits. The pair of the outer two pixels has 9 bits. Rows -c and 4c - pair: what is added to
  // nothing is free, what is subtracted from nothing is not. Two places in the chain, each with an adder, the
  // first with a selector too, and a valid bit.
  const FilterArithmetic filter = filter_arithmetic(laplacian(1));
  EXPECT_EQ(filter.chain_bits, 2 * 17 + 1);
  EXPECT_EQ(filter.resources, (Resources{kRest + kEdges + 9 + (1 + 2) * 17 + (2 + 1) * 17,
                                         kRestFlipFlops + 3 * 8 + 2 * 17 + filter.chain_bits}));
}

TEST(FilterArithmetic, SharesEqualRowsAndAddsPairsInSymmetricRowsOnly) {
  // Sobel: rows b - a and 2b - 2a, of pixels that are no pairs.
  const FilterKernel sobel{3, {-1, 0, 1, -2, 0, 2, -1, 0, 1}, 3};
  constexpr int kCommon = kRest + kEdges + (2 + 1) * 17;
  EXPECT_EQ(filter_arithmetic(sobel).resources.luts, kCommon + (1 + 1) * 17);
  // With one row that differs, that row is not shared.
  FilterKernel other = sobel;
  other.weights[7] = 1;
  other.weights[8] = 0;
  EXPECT_EQ(filter_arithmetic(other).resources.luts, kCommon + (1 + 1 + 1) * 17);
}

TEST(FilterArithmetic, HasSumsAsWideAsTheWeightsMakeThem) {
  const auto chain_bits = [](int weight) { return filter_arithmetic(laplacian(weight)).chain_bits; };
  EXPECT_EQ(chain_bits(64), 2 * 17 + 1);  // 4 * 64 * 255 is 65280
  EXPECT_EQ(chain_bits(65), 2 * 18 + 1);
}

TEST(FilterArithmetic, MultipliesByWeightsThatAreNoPowerOfTwo) {
  const auto multipliers = [](int weight) {
    return filter_arithmetic({3, {0, 0, 0, weight, -2 * weight, weight, 0, 0, 0}, 0}).resources.multipliers;
  };
  for (const int weight : {1, -1, 2, 4, -8, 16384, -16384}) EXPECT_EQ(multipliers(weight), 0) << weight;
  for (const int weight : {3, -3, 5, 6, 7, 16383, -16383}) EXPECT_EQ(multipliers(weight), 2) << weight;
}

TEST(FilterArithmetic, SharesEqualProducts) {
  EXPECT_EQ(filter_arithmetic({3, {0, 3, 0, 0, -6, 0, 0, 3, 0}, 0}).resources.multipliers, 2);
  EXPECT_EQ(filter_arithmetic({3, {3, 0, 0, 0, 0, 0, -3, 0, 0}, 0}).resources.multipliers, 1);
}

TEST(FilterArithmetic, CountsThePartsOfLog7) {
  // Three pairs; four rows, with 3, 4, 3 and 4 additions; six places in the chain, three with a selector.
  const FilterArithmetic filter = filter_arithmetic(kernels::log7());
  EXPECT_EQ(filter.resources, (Resources{kRest + 3 * kEdges + 27 + 14 * 17 + (6 + 3) * 17,
                                         kRestFlipFlops + 7 * 8 + 4 * 17 + 6 * 17 + 3, 0, 10}));
}

}  // namespace
}  // namespace stereotlm::area
