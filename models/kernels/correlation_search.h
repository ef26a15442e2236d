#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/correlation.h"
#include "models/kernels/simd.h"
#include "models/kernels/simd_array.h"

namespace stereotlm::kernels {

// Finds the best candidates of single windows by the cost `zncc`, with exact fractions; used by ImageMatcher
// for windows that the vector loops leave undecided. Sums of products are kept from column to column and from
// row to row, so that neighbouring windows cost little more than the comparison of their candidates.
class CorrelationSearch {
 public:
  // Images of `width` columns.
  CorrelationSearch(int width, int window, int disparities, const Simd& simd);
  CorrelationSearch(const CorrelationSearch&) = delete;
  CorrelationSearch& operator=(const CorrelationSearch&) = delete;

  // Begins a pair of images, which must stay as they are until the next one.
  void set_images(const std::uint8_t* left, const std::uint8_t* right);
  // Sets the row at which the windows begin: a later one than the last of this pair.
  void set_row(int row);
  // The disparity of the window that begins at this column: right of the last of this row.
  std::uint8_t left_based(int column) { return best_of(left_windows_, column, column + 1); }
  std::uint8_t right_based(int column) { return best_of(right_windows_, column, windows_across_ - column); }

 private:
  // One side's image. As candidates the left windows are in the order of their columns, and the right ones in
  // the opposite order, so that disparities ascend.
  struct Side {
    bool is_reversed = false;
    const std::uint8_t* image = nullptr;
    std::vector<std::uint8_t> rows;           // the last window + 1 rows, padded, in the order of candidates
    std::vector<std::int32_t> column_pixels;  // sums over the rows of the windows
    std::vector<std::int32_t> column_squares;
    // For each window, in the order of candidates.
    std::vector<double> sums;  // of its pixels
    std::vector<std::int64_t> variances;
    std::vector<double> inverses;  // 1 / variance
  };
  // The windows of one side, and their candidates.
  struct Windows {
    const Side& own;
    const Side& other;
    LaneArray<std::int32_t> columns;  // [column][candidate]: products of the pixels, summed over the rows
    std::vector<int> column_rows;     // the row of windows that `columns` belongs to
    LaneArray<std::int32_t> sums;     // [candidate]: of the columns begin..end-1, at most `window`
    int begin = 0;
    int end = 0;
  };

  Windows windows_of(const Side& own, const Side& other) const;
  void move_sums(Side& side, int row);
  void copy_row(Side& side, int row);
  void add_up(Side& side);
  std::size_t place_of_row(int row) const;
  std::size_t place_of_window(const Side& side, int column) const;
  void enter_column(Windows& windows);
  std::uint8_t best_of(Windows& windows, int column, int most);

  int width_;
  int window_;
  int disparities_;
  int windows_across_;
  int lanes_;
  const CorrelationSimd& simd_;
  int row_ = 0;
  int next_row_ = 0;  // the first row of the images that has not been copied to Side::rows
  Side left_;
  Side right_;
  Windows left_windows_;
  Windows right_windows_;
  LaneArray<std::int32_t> no_column_;
  std::vector<const std::uint8_t*> rows_;
  std::vector<std::int16_t> own_pixels_;
  std::vector<double> quotients_;
};

}  // namespace stereotlm::kernels
