#include "models/kernels/stereo_pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/kernels/words.h"
#include "tests/support/random_board.h"
#include "tests/support/reference_arithmetic.h"
#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

using test::RandomBoard;
using test::SplitMix64;

// All pictures of the board through one pipeline for each instruction set, there and back, so that nothing of
// a frame reaches the next.
void expect_reference(const RandomBoard& board) {
  const StereoConfig config{board.window, board.disparities, test::filter_kernel(board.filter),
                            board.lr_tolerance};
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
  for (const ImageLoops* loops : image_loops()) {
    SCOPED_TRACE(loops->name);
    StereoPipeline pipeline(board.width, board.height, config, *loops);
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
    board.frames = static_cast<int>(board.pictures.size());
    SCOPED_TRACE(describe(board));
    ASSERT_NO_FATAL_FAILURE(expect_reference(board));
  }
}

RandomBoard noise_board(int width, int height, int window, int disparities, SplitMix64& random) {
  RandomBoard board;
  board.width = width;
  board.height = height;
  board.window = window;
  board.disparities = disparities;
  board.lr_tolerance = 1;
  board.pictures.resize(1);
  const int levels = random.chance(50) ? 2 : 256;
  for (auto* side : {&board.pictures[0].left, &board.pictures[0].right}) {
    for (int pixel = 0; pixel < width * height; ++pixel)
      side->push_back(static_cast<std::uint8_t>(random.between(0, levels - 1) * 255 / (levels - 1)));
  }
  return board;
}

// Wide images have segments of several vectors in every lane; many disparities reach over more than one of
// them.
TEST(StereoPipeline, EqualsTheReferenceOnWideAndOnHighImages) {
  SplitMix64 random(11);
  for (int window = 3; window <= 31; window += 2) {
    for (const auto& [width, height] : {std::pair(4 * random.between(50, 110), window + random.between(0, 3)),
                                        std::pair(4 * random.between(8, 14), random.between(50, 150))}) {
      const RandomBoard board = noise_board(width, height, window, random.between(1, 254), random);
      SCOPED_TRACE("window " + std::to_string(window) + ", disparities " + std::to_string(board.disparities) +
                   ", " + std::to_string(width) + " x " + std::to_string(height));
      ASSERT_NO_FATAL_FAILURE(expect_reference(board));
    }
  }
}

TEST(StereoPipeline, EqualsTheReferenceForEachCountOfDisparities) {
  SplitMix64 random(12);
  for (int disparities = 1; disparities <= 254; ++disparities) {
    const int window = 2 * random.between(1, 6) + 1;
    const RandomBoard board = noise_board(4 * random.between(1, 40), window + 1, window, disparities, random);
    SCOPED_TRACE("window " + std::to_string(window) + ", disparities " + std::to_string(disparities) +
                 ", width " + std::to_string(board.width));
    ASSERT_NO_FATAL_FAILURE(expect_reference(board));
  }
}

void expect_filtered(int width, int height, const std::vector<std::uint8_t>& image,
                     const test::ReferenceKernel& kernel) {
  const auto expected = test::reference_filter(width, height, image, kernel);
  for (const ImageLoops* loops : image_loops()) {
    ImageFilter filter(width, height, *test::filter_kernel(kernel), *loops);
    std::vector<std::uint8_t> filtered(image.size() + ImageFilter::kPadding);
    filter.run(image.data(), filtered.data());
    filtered.resize(image.size());
    ASSERT_EQ(filtered, expected) << loops->name;
  }
}

// 255 times the positive weights on both sides of 2^31; all shifts.
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

// Kernels with equal rows, whose pixels are added first: all of them, pairs, none.
TEST(ImageFilter, AddsEqualKernelRowsFirst) {
  SplitMix64 random(14);
  for (const int size : {3, 7, 9, 31}) {
    for (const int kinds : {1, 2, 3, 31}) {
      test::ReferenceKernel kernel{size, {}, 4};
      for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column)
          kernel.weights.push_back((row % kinds + 1) * (column - size / 2));
      }
      const RandomBoard board = noise_board(4 * random.between(1, 30), random.between(1, 40), 3, 2, random);
      ASSERT_NO_FATAL_FAILURE(expect_filtered(board.width, board.height, board.pictures[0].left, kernel))
          << "size " << size << ", kinds " << kinds;
    }
  }
}

TEST(StereoPipeline, RefusesABrokenConfigurationAndNoImage) {
  StereoConfig config;
  EXPECT_NO_THROW(StereoPipeline(4, 1, config));
  EXPECT_THROW(StereoPipeline(0, 1, config), std::invalid_argument);
  config.window = 4;
  EXPECT_THROW(StereoPipeline(8, 8, config), std::invalid_argument);
  config = {};
  config.disparities = 255;
  EXPECT_THROW(StereoPipeline(8, 8, config), std::invalid_argument);
  config = {};
  config.lr_tolerance = 254;
  EXPECT_THROW(StereoPipeline(8, 8, config), std::invalid_argument);
  config = {};
  config.filter->shift = 32;
  EXPECT_THROW(StereoPipeline(8, 8, config), std::invalid_argument);
}

TEST(ImageLoops, AreThoseOfThisMachine) {
  std::set<std::string> names;
  for (const ImageLoops* loops : image_loops()) {
    names.insert(loops->name);
    EXPECT_LE(loops->lanes, kMostImageLanes);
    EXPECT_LE(loops->lanes, image_loops().front()->lanes);
  }
  EXPECT_EQ(names.size(), image_loops().size());
  EXPECT_EQ(names.count("base"), 1U);
}

}  // namespace
}  // namespace stereotlm::kernels
