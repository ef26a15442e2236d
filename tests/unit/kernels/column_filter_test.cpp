#include "models/kernels/column_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
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

// Column fetch: the rows of a window at once, from the first strip that the matcher needs.
void expect_filtered_by_columns(const RandomBoard& board, SplitMix64& random) {
  const int half = board.filter ? (board.filter->size - 1) / 2 : 0;
  const int radius = (board.window - 1) / 2;
  const int lead = std::max(0, half - radius);
  expect_two_frames(board, {board.window, 1, half - radius - lead, lead + board.height}, random);
}

// Line buffers: one row at a time, from the first row of the image.
void expect_filtered_by_rows(const RandomBoard& board, SplitMix64& random) {
  const int half = board.filter ? (board.filter->size - 1) / 2 : 0;
  expect_two_frames(board, {1, 1, 0, board.height + half + (board.window - 1) / 2}, random);
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
      ASSERT_NO_FATAL_FAILURE(expect_filtered_by_columns(board, random));
      ASSERT_NO_FATAL_FAILURE(expect_filtered_by_rows(board, random));
    }
  }
}

}  // namespace
}  // namespace stereotlm::kernels
