#include <gtest/gtest.h>

#include <algorithm>
#include <bitset>
#include <string>
#include <vector>

#include "models/kernels/census.h"
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

}  // namespace
}  // namespace stereotlm::kernels
