#include "models/kernels/stereo_pipeline.h"

#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/random_board.h"
#include "tests/support/reference_arithmetic.h"
#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

using test::RandomBoard;
using test::SplitMix64;

// Sends all pictures of the board through one pipeline for each instruction set, forwards and backwards: no
// frame may leave a trace in the next.
void expect_literal_frame(const RandomBoard& board) {
  const auto entries = [](const std::optional<std::vector<std::uint32_t>>& table) {
    return table ? table->data() : nullptr;
  };
  std::vector<std::size_t> order;
  for (std::size_t picture = 0; picture < board.pictures.size(); ++picture) order.push_back(picture);
  for (std::size_t picture = board.pictures.size(); picture-- > 0;) order.push_back(picture);
  std::vector<std::vector<std::uint8_t>> expected;
  for (std::size_t picture = 0; picture < board.pictures.size(); ++picture)
    expected.push_back(
        test::compute_reference(test::reference_input(board, static_cast<int>(picture))).disparity);
  for (const Simd* simd : simd_sets()) {
    SCOPED_TRACE(simd->name);
    StereoPipeline pipeline(board.width, board.height, test::stereo_config(board), *simd);
    for (const std::size_t picture : order) {
      std::vector<std::uint8_t> disparity(expected[picture].size(), 99);
      pipeline.run(board.pictures[picture].left.data(), board.pictures[picture].right.data(),
                   entries(board.left_table), entries(board.right_table), disparity.data());
      ASSERT_EQ(disparity, expected[picture]);
    }
  }
}

TEST(StereoPipeline, EqualsTheReferenceOnRandomBoardsWithEachInstructionSet) {
  for (std::uint64_t seed = 7000; seed < 7400; ++seed) {
    RandomBoard board = test::make_random_board(seed);
    board.cost = test::any_cost(static_cast<int>(seed));
    board.frames = static_cast<int>(board.pictures.size());
    SCOPED_TRACE(describe(board));
    ASSERT_NO_FATAL_FAILURE(expect_literal_frame(board));
  }
}

// Matches noise pictures, with a left-right check. Two grey levels make many sums equal.
void expect_noise_matches(int width, int height, int window, int disparities, int cost, SplitMix64& random) {
  SCOPED_TRACE("window " + std::to_string(window) + ", disparities " + std::to_string(disparities) + ", " +
               std::to_string(width) + " x " + std::to_string(height));
  RandomBoard board = test::noise_board(width, height, window, random, random.chance(50) ? 2 : 256);
  board.disparities = disparities;
  board.lr_tolerance = 1;
  board.cost = test::any_cost(cost);
  SCOPED_TRACE(name_of(test::matching_cost(board.cost).kind));
  expect_literal_frame(board);
}

// In wide images a lane's segment is several vectors long, and many disparities reach over more than one.
// High images have a band for each lane. The reference is slow: it compares each window pixel by pixel.
TEST(StereoPipeline, EqualsTheReferenceOnWideAndOnHighImages) {
  SplitMix64 random(11);
  int cost = 0;
  for (int window = 3; window <= 31; window += 4, ++cost) {
    const int most = window <= 7 ? 254 : 24;
    ASSERT_NO_FATAL_FAILURE(expect_noise_matches(4 * random.between(50, 110), window, window,
                                                 random.between(17, most), cost, random));
    ASSERT_NO_FATAL_FAILURE(expect_noise_matches(window + 4 * random.between(1, 6) + 1,
                                                 window + random.between(20, 60), window,
                                                 random.between(1, 12), cost + 3, random));
  }
}

// Disparities are matched in groups, of which the last may be smaller. The windows lie on both sides of those
// whose sums fit into the narrowest keys.
TEST(StereoPipeline, EqualsTheReferenceForEachSizeOfTheLastGroupOfDisparities) {
  SplitMix64 random(12);
  for (int cost = 0; cost < test::kCosts; ++cost) {
    for (const int window : {3, 9, 19, 27}) {
      for (int disparities = 1; disparities <= 8; ++disparities) {
        const int width = 4 * ((window + disparities + 6) / 4);
        ASSERT_NO_FATAL_FAILURE(expect_noise_matches(width, window, window, disparities, cost, random));
      }
    }
    for (int disparities = 251; disparities <= 254; ++disparities)
      ASSERT_NO_FATAL_FAILURE(expect_noise_matches(260, 3, 3, disparities, cost, random));
  }
}

void expect_filtered(int width, int height, const std::vector<std::uint8_t>& image,
                     const test::ReferenceKernel& kernel) {
  const auto expected = test::reference_filter(width, height, image, kernel);
  for (const Simd* simd : simd_sets()) {
    ImageFilter filter(width, height, *test::filter_kernel(kernel), *simd);
    std::vector<std::uint8_t> filtered(image.size() + ImageFilter::kPadding);
    filter.run(image.data(), filtered.data());
    filtered.resize(image.size());
    ASSERT_EQ(filtered, expected) << simd->name;
  }
}

// 255 times the positive weights lies on both sides of 2^31.
TEST(ImageFilter, IsExactOnBothSidesOf32Bits) {
  constexpr int kPairs = 257;  // 255 * (257 * 32767 + 385) = 2^31 - 128
  for (const int more : {385, 386}) {
    for (int shift = 0; shift < 32; ++shift) {
      test::ReferenceKernel kernel{31, std::vector<int>(std::size_t{31} * 31, 0), shift};
      for (std::size_t pair = 0; pair < kPairs; ++pair) {
        kernel.weights[3 * pair] = 32767;
        kernel.weights[3 * pair + 1] = -32767;
      }
      kernel.weights[2] = more;
      kernel.weights[5] = -more;
      for (const bool positive : {true, false}) {
        // White where the kernel around (17, 16) has weights of one sign.
        GrayImage image(36, 33);
        for (int row = 0; row < 31; ++row) {
          for (int column = 0; column < 31; ++column) {
            const int weight = test::filter_kernel(kernel)->weight(column, row);
            if (positive ? weight > 0 : weight < 0) image.at(column + 2, row + 1) = 255;
          }
        }
        ASSERT_NO_FATAL_FAILURE(expect_filtered(image.width, image.height, image.pixels, kernel))
            << "shift " << shift << ", more " << more;
      }
    }
  }
}

// The filter adds the pixels of equal kernel rows first. Here all rows are equal, some, or none.
TEST(ImageFilter, IsExactForKernelsWithEqualRows) {
  SplitMix64 random(14);
  for (const int size : {3, 7, 9, 31}) {
    for (const int kinds : {1, 2, 3, 31}) {
      test::ReferenceKernel kernel{size, {}, 4};
      for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column)
          kernel.weights.push_back((row % kinds + 1) * (column - size / 2));
      }
      const RandomBoard board =
          test::noise_board(4 * random.between(1, 30), random.between(1, 40), 3, random);
      ASSERT_NO_FATAL_FAILURE(expect_filtered(board.width, board.height, board.pictures[0].left, kernel))
          << "size " << size << ", kinds " << kinds;
    }
  }
}

TEST(StereoPipeline, RefusesABrokenConfigurationAndAnEmptyImage) {
  EXPECT_NO_THROW(StereoPipeline(4, 1, {}));
  EXPECT_THROW(StereoPipeline(0, 1, {}), std::invalid_argument);
  EXPECT_THROW(StereoPipeline(8, 8, {4, 80, log7(), 0}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::kernels
