#include "models/kernels/census_columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bitset>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/kernels/census_transform.h"
#include "models/kernels/simd.h"
#include "tests/support/random_board.h"
#include "tests/support/reference_arithmetic.h"
#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

using test::SplitMix64;

int differing_bits(const std::uint8_t* a, const std::uint8_t* b, int bytes) {
  std::size_t bits = 0;
  for (int byte = 0; byte < bytes; ++byte)
    bits += std::bitset<8>(static_cast<unsigned>(a[byte] ^ b[byte])).count();
  return static_cast<int>(bits);
}

// The order of the bits is free: compares the number of bits, and the distances from the first pixels.
void expect_census(int width, const std::vector<std::uint8_t>& found,
                   const std::vector<std::uint64_t>& expected, int bytes) {
  const std::vector<std::uint8_t> no_bit(static_cast<std::size_t>(bytes));
  for (std::size_t pixel = 0; pixel < expected.size(); ++pixel) {
    const std::uint8_t* const own = found.data() + pixel * static_cast<std::size_t>(bytes);
    ASSERT_EQ(differing_bits(own, no_bit.data(), bytes),
              static_cast<int>(std::bitset<64>(expected[pixel]).count()))
        << pixel % static_cast<std::size_t>(width);
    for (std::size_t other = 0; other < std::min<std::size_t>(expected.size(), 70); ++other) {
      ASSERT_EQ(differing_bits(own, found.data() + other * static_cast<std::size_t>(bytes), bytes),
                static_cast<int>(std::bitset<64>(expected[pixel] ^ expected[other]).count()))
          << pixel << ", " << other;
    }
  }
}

TEST(CensusTransform, EqualsTheLiteralBitsWithEachInstructionSet) {
  SplitMix64 random(21);
  for (const int size : {3, 5, 7}) {
    const MatchingCost cost{CostKind::kCensus, size};
    const int bytes = cost.pixel_bytes();
    for (const auto& [width, height] :
         {std::pair(4, 1), std::pair(8, 3), std::pair(68, 9), std::pair(140, 5)}) {
      for (const int levels : {2, 256}) {
        const auto image = test::noise_board(width, height, 3, random, levels).pictures[0].left;
        const auto expected = test::reference_census(width, height, image, size);
        for (const Simd* simd : simd_sets()) {
          CensusTransform census(width, height, cost, *simd);
          census.run(image.data());
          std::vector<std::uint8_t> found;
          for (std::size_t pixel = 0; pixel < image.size(); ++pixel) {
            for (int byte = 0; byte < bytes; ++byte) found.push_back(census.plane(byte)[pixel]);
          }
          SCOPED_TRACE(simd->name);
          ASSERT_NO_FATAL_FAILURE(expect_census(width, found, expected, bytes));
        }
      }
    }
  }
}

// Sends an image through the stage in columns of n + R - 1 rows, or of one row, from a first row that may lie
// far above the image. Rows outside the image hold noise.
void expect_columns(int size, int rows_per_column, int rows_per_strip, int first_row, SplitMix64& random) {
  constexpr int kWidth = 20;
  constexpr int kHeight = 11;
  const MatchingCost cost{CostKind::kCensus, size};
  const int half = cost.half();
  const int bytes = cost.pixel_bytes();
  CensusColumns census(kWidth, kHeight, rows_per_column, rows_per_strip, cost);
  for (int frame = 0; frame < 2; ++frame) {
    const auto image = test::noise_board(kWidth, kHeight, 3, random, 5).pictures[0].left;
    const auto expected = test::reference_census(kWidth, kHeight, image, size);
    std::vector<std::uint8_t> found(expected.size() * static_cast<std::size_t>(bytes), 0xFF);
    std::vector<int> seen(expected.size());
    const auto inside = [](int row) { return row >= 0 && row < kHeight; };
    census.start_frame(first_row);
    const int strips = (kHeight + half - first_row + rows_per_strip - 1) / rows_per_strip;
    for (int count = 0; count < strips * kWidth + half; ++count) {
      std::vector<std::uint8_t> pixels;
      std::uint64_t valid = 0;
      for (int k = 0; k < rows_per_column; ++k) {
        const int row = first_row + count / kWidth * rows_per_strip + k;
        const int column = count % kWidth;
        pixels.push_back(inside(row) ? image[static_cast<std::size_t>(row * kWidth + column)]
                                     : static_cast<std::uint8_t>(random.between(0, 255)));
        valid |= std::uint64_t{(row + column) % 3 == 0} << k;
      }
      const PixelColumn out = census.push({pixels.data(), valid});
      if (count < half) continue;
      const int column = (count - half) % kWidth;
      for (int k = 0; k < rows_per_column; ++k) {
        const int row = first_row + (count - half) / kWidth * rows_per_strip - half + k;
        if (!inside(row)) continue;
        const auto place = static_cast<std::size_t>(row * kWidth + column);
        std::copy_n(out.values + k * bytes, bytes,
                    found.begin() + static_cast<std::ptrdiff_t>(place) * bytes);
        ++seen[place];
        ASSERT_EQ((out.valid >> k & 1U) != 0, (row + column) % 3 == 0) << row << ", " << column;
      }
    }
    ASSERT_EQ(std::count(seen.begin(), seen.end(), 0), 0);
    ASSERT_NO_FATAL_FAILURE(expect_census(kWidth, found, expected, bytes));
  }
}

TEST(CensusColumns, EqualTheLiteralBitsInEveryOrderOfFetching) {
  SplitMix64 random(22);
  for (const int size : {3, 5, 7}) {
    for (const int window : {3, 7, 31}) {
      for (const int rows : {1, 4, 16}) {
        // Row 0 of the first strip, or a strip that holds no row of the image.
        for (const int first_row : {0, -(window + rows - 1), -40}) {
          SCOPED_TRACE("size " + std::to_string(size) + ", window " + std::to_string(window) + ", rows " +
                       std::to_string(rows) + ", first row " + std::to_string(first_row));
          ASSERT_NO_FATAL_FAILURE(expect_columns(size, window + rows - 1, rows, first_row, random));
        }
      }
    }
    for (const int first_row : {0, -15})
      ASSERT_NO_FATAL_FAILURE(expect_columns(size, 1, 1, first_row, random));
  }
}

TEST(Census, RefusesSizesOutsideTheirRange) {
  EXPECT_NO_THROW(CensusColumns(4, 1, 3, 1, {CostKind::kCensus, 7}));
  EXPECT_NO_THROW(CensusTransform(4, 1, {CostKind::kCensus, 3}));
  for (const int size : {1, 4, 9}) {
    EXPECT_THROW(CensusColumns(4, 1, 3, 1, {CostKind::kCensus, size}), std::invalid_argument);
    EXPECT_THROW(CensusTransform(4, 1, {CostKind::kCensus, size}), std::invalid_argument);
  }
  EXPECT_THROW(CensusTransform(0, 1, {CostKind::kCensus, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::kernels
