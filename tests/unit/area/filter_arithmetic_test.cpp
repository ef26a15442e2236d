#include "models/area/filter_arithmetic.h"

#include <gtest/gtest.h>

#include "tests/unit/area/resources.h"

namespace stereotlm::area {
namespace {

using kernels::FilterKernel;

FilterKernel laplacian(int shift) { return {3, {0, -1, 0, -1, 4, -1, 0, -1, 0}, shift}; }

TEST(FilterArithmetic, IsTheSumOfItsAdders) {
  // c is the middle pixel of a row; the pair, of 9 bits, is the sum of the outer two. Row -c needs no adder.
  // Row 4c - pair is -510..1020, 11 bits; the lowest two of 4c need no adder. Chain: 8 bits of -255..0, then
  // two adders of 11 bits. 11 bits are clamped to 8.
  const FilterArithmetic filter = filter_arithmetic(laplacian(0));
  EXPECT_EQ(filter.resources, (Resources{9 + (11 - 2) + 2 * 11 + 8 + 1, 8 + 11}));
  EXPECT_EQ(filter.chain_bits, 8 + 11);
}

TEST(FilterArithmetic, ClampsResultsOfMoreThanEightBits) {
  const std::int64_t without = filter_arithmetic(laplacian(3)).resources.luts;  // -128..127
  EXPECT_EQ(without, 9 + 9 + 2 * 11);
  EXPECT_EQ(filter_arithmetic(laplacian(2)).resources.luts, without + 8 + 1);  // 9 bits
  const FilterKernel wide = {3, {0, -2, 0, -2, 8, -2, 0, -2, 0}, 0};
  const FilterKernel wider = {3, {0, -8, 0, -8, 32, -8, 0, -8, 0}, 0};
  const auto clamp_of = [](FilterKernel kernel) {
    const std::int64_t clamped = filter_arithmetic(kernel).resources.luts;
    kernel.shift = 31;
    return clamped - filter_arithmetic(kernel).resources.luts;
  };
  EXPECT_EQ(clamp_of(laplacian(0)), 8 + 1);  // 11 bits: the upper 4 in one LUT
  EXPECT_EQ(clamp_of(wide), 8 + 2);          // 12 bits
  EXPECT_EQ(clamp_of(wider), 8 + 3);         // 14 bits
}

TEST(FilterArithmetic, SharesEqualRowsAndAddsPairsInSymmetricRowsOnly) {
  // Sobel: rows b - a of 9 bits and 2b - 2a of 10, the lowest of which needs no adder; a chain of 9, 11 and
  // 11 bits.
  const FilterArithmetic filter = filter_arithmetic({3, {-1, 0, 1, -2, 0, 2, -1, 0, 1}, 3});
  EXPECT_EQ(filter.resources, (Resources{9 + (10 - 1) + 2 * 11, 9 + 11}));
  // With one row that differs, that row is not shared.
  const FilterArithmetic other = filter_arithmetic({3, {-1, 0, 1, -2, 0, 2, -1, 1, 0}, 3});
  EXPECT_EQ(other.resources, (Resources{9 + (10 - 1) + 9 + 2 * 11, 9 + 11}));
}

TEST(FilterArithmetic, MultipliesByWeightsThatAreNoPowerOfTwo) {
  const auto multipliers = [](int weight) {
    return filter_arithmetic({3, {0, 0, 0, weight, -2 * weight, weight, 0, 0, 0}, 0}).resources.multipliers;
  };
  for (const int weight : {1, -1, 2, 4, -8, 16384, -16384}) EXPECT_EQ(multipliers(weight), 0) << weight;
  for (const int weight : {3, -3, 5, 6, 7, 16383, -16383}) EXPECT_EQ(multipliers(weight), 2) << weight;
}

TEST(FilterArithmetic, CountsThePartsOfLog7) {
  // Three pairs of 9 bits. Weights of a row, outermost first; bits of its adders, less those without adder:
  //   1 3 5        11, 12
  //   1 6 14 16    12-1, 14-1, 14-4
  //   3 14 -35     14-1, 15
  //   5 16 -35 -112    14-4, 16, 17-4
  // Chain: 12 bits of row 0, then adders of 15, 16, 17, 17, 17 and 17 bits. 11 bits are clamped to 8.
  const FilterArithmetic filter = filter_arithmetic(kernels::log7());
  constexpr int kRows = (11 + 12) + (11 + 13 + 10) + (13 + 15) + (10 + 16 + 13);
  EXPECT_EQ(filter.resources, (Resources{27 + kRows + (15 + 16 + 4 * 17) + 9, 12 + 15 + 16 + 3 * 17, 0, 10}));
  EXPECT_EQ(filter.chain_bits, 94);
}

TEST(FilterArithmetic, IsEmptyForAKernelOfZeros) {
  const FilterArithmetic filter = filter_arithmetic({3, std::vector<int>(9, 0), 0});
  EXPECT_EQ(filter.resources, (Resources{}));
  EXPECT_EQ(filter.chain_bits, 0);
}

TEST(FilterArithmetic, HoldsTheLargestSums) {
  FilterKernel kernel = {31, std::vector<int>(961, 32767), 0};
  for (std::size_t i = 0; i < 480; ++i) kernel.weights[i] = -32767;
  kernel.weights[480] = 0;
  const FilterArithmetic filter = filter_arithmetic(kernel);
  // 480 * 32767 * 255 needs 32 bits and a sign.
  EXPECT_EQ(bits_of(Range{-480LL * 32767 * 255, 480LL * 32767 * 255}), 33);
  EXPECT_LE(filter.chain_bits, 30 * 33);
  EXPECT_GT(filter.chain_bits, 30 * 27);
}

}  // namespace
}  // namespace stereotlm::area
