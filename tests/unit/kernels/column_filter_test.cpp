#include "models/kernels/column_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "tests/support/random_board.h"
#include "tests/support/reference_arithmetic.h"
#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

using test::RandomBoard;
using test::SplitMix64;

// How a frame is cut into columns.
struct Strips {
  int rows_per_column;
  int rows_per_strip;
  int first_row;
  int strips;
};

// Sends one frame through the filter. Pixel (u, v) must leave filtered, with its own valid bit, `half`
// columns after it entered and `half` rows further up. Rows outside the image hold random pixels.
void expect_filtered(ColumnFilter& filter, const RandomBoard& board, const Strips& cut, SplitMix64& random) {
  const auto [rows_per_column, rows_per_strip, first_row, strips] = cut;
  const int half = board.filter ? (board.filter->size - 1) / 2 : 0;
  const auto& pixels = board.pictures.front().left;
  const auto expected = test::reference_filter(board.width, board.height, pixels, board.filter);
  std::vector<bool> valid;
  for (std::size_t index = 0; index < pixels.size(); ++index) valid.push_back(random.chance(70));
  const auto inside = [&](int row) { return row >= 0 && row < board.height; };
  const auto place = [&](int column, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(board.width) +
           static_cast<std::size_t>(column);
  };
  filter.start_frame(first_row);
  for (int count = 0; count < strips * board.width + half; ++count) {
    for (int k = 0; k < rows_per_column; ++k) {
      const int row = first_row + count / board.width * rows_per_strip + k;
      const MaskedPixel outside{static_cast<std::uint8_t>(random.between(0, 255)), random.chance(50)};
      const auto from = inside(row) ? place(count % board.width, row) : 0;
      const bool complete = filter.push(inside(row) ? MaskedPixel{pixels[from], valid[from]} : outside);
      ASSERT_EQ(complete, k == rows_per_column - 1);
    }
    if (count < half) continue;
    const int column = (count - half) % board.width;
    for (int k = 0; k < rows_per_column; ++k) {
      const int row = first_row + (count - half) / board.width * rows_per_strip - half + k;
      if (!inside(row)) continue;
      const auto at = static_cast<std::size_t>(k);
      ASSERT_EQ(int{filter.output().values[at]}, expected[place(column, row)]) << column << ", " << row;
      ASSERT_EQ((filter.output().valid >> k & 1U) != 0, valid[place(column, row)]) << column << ", " << row;
    }
  }
}

// Two frames through one filter, with each instruction set.
void expect_two_frames(const RandomBoard& board, const Strips& cut, SplitMix64& random) {
  for (const Simd* simd : simd_sets()) {
    SCOPED_TRACE(simd->name);
    ColumnFilter filter(board.width, board.height, cut.rows_per_column, cut.rows_per_strip,
                        test::filter_kernel(board.filter), *simd);
    for (int frame = 0; frame < 2; ++frame) {
      ASSERT_NO_FATAL_FAILURE(expect_filtered(filter, board, cut, random));
    }
  }
}

// Column fetch: the rows of `rows` windows at once, from the first strip that the matcher needs.
void expect_filtered_by_columns(const RandomBoard& board, int rows, SplitMix64& random) {
  const int half = board.filter ? (board.filter->size - 1) / 2 : 0;
  const int radius = (board.window - 1) / 2;
  const int lead = (std::max(0, half - radius) + rows - 1) / rows;
  const int strips = lead + (board.height + rows - 1) / rows;
  expect_two_frames(board, {board.window + rows - 1, rows, half - radius - lead * rows, strips}, random);
}

// Line buffers: one row at a time, from the first row of the image.
void expect_filtered_by_rows(const RandomBoard& board, SplitMix64& random) {
  const int half = board.filter ? (board.filter->size - 1) / 2 : 0;
  expect_two_frames(board, {1, 1, 0, board.height + half + (board.window - 1) / 2}, random);
}

test::ReferenceKernel differences_kernel(int size) {
  test::ReferenceKernel kernel{size, {}, 3};
  for (int place = 0; place < size * size; ++place) kernel.weights.push_back(place * 7 % 23);
  const int sum = std::accumulate(kernel.weights.begin(), kernel.weights.end(), 0);
  kernel.weights[static_cast<std::size_t>(size * size / 2)] -= sum;
  return kernel;
}

// Half a kernel is smaller than, equal to and larger than half a window. Windows lie around multiples of the
// vectors' length, and images go down to the smallest.
TEST(ColumnFilter, EqualsTheLiteralFilterForEachPairOfSizes) {
  SplitMix64 random(6);
  for (const int size : {3, 5, 7, 9, 17, 31}) {
    for (const int window : {3, 5, 7, 9, 15, 17, 31}) {
      for (const auto& [width, height] :
           {std::pair(4, 1), std::pair(4, 40), std::pair(36, 3), std::pair(20, 33)}) {
        SCOPED_TRACE("kernel " + std::to_string(size) + ", window " + std::to_string(window) + ", image " +
                     std::to_string(width) + " x " + std::to_string(height));
        RandomBoard board = test::noise_board(width, height, window, random);
        board.filter = differences_kernel(size);
        for (const int rows : {1, 2, 16})
          ASSERT_NO_FATAL_FAILURE(expect_filtered_by_columns(board, rows, random));
        ASSERT_NO_FATAL_FAILURE(expect_filtered_by_rows(board, random));
      }
    }
  }
}

// 255 * 65793 is the last multiple of 255 below 2^24, up to which a float holds every integer exactly. At
// each shift, different low bits of the sum decide the result.
TEST(ColumnFilter, IsExactOnBothSidesOf24Bits) {
  SplitMix64 random(7);
  for (const int more : {0, 1, 2}) {
    for (int shift = 0; shift < 32; ++shift) {
      SCOPED_TRACE("positive weights " + std::to_string(65793 + more) + ", shift " + std::to_string(shift));
      RandomBoard board = test::noise_board(12, 9, 3, random);
      board.filter = {3, {32767, -32768, 259 + more, -32768, -257 - more, 32767, 0, 0, 0}, shift};
      for (std::uint8_t& pixel : board.pictures[0].left) {
        if (pixel > 60) pixel = random.chance(50) ? 255 : 0;
      }
      ASSERT_NO_FATAL_FAILURE(expect_filtered_by_columns(board, 1, random));
      ASSERT_NO_FATAL_FAILURE(expect_filtered_by_rows(board, random));
    }
  }
}

}  // namespace
}  // namespace stereotlm::kernels
