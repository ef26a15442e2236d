#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/correlation.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Finds the best candidates of single windows by the cost `zncc`, with exact fractions; used by ImageMatcher
// for windows that the vector loops leave undecided. Sums of products are kept from column to column and from
// row to row, so that neighbouring windows cost little more than the comparison of their candidates.
//
// The right image is mirrored. Then both sides do the same: the candidates of a window at column u of its own
// image are windows of the other image in the order of their columns, from across - 1 - u on.
class CorrelationSearch {
 public:
  CorrelationSearch(int width, int height, int window, int disparities, const Simd& simd);

  // Begins a pair of images.
  void set_images(const std::uint8_t* left, const std::uint8_t* right);
  // Sets the row at which the windows begin: a later one than the last of this pair.
  void set_row(int row);
  // The disparity of the window that begins at this column. In a row the columns of the left image must
  // ascend, and those of the right image descend.
  std::uint8_t left_based(int column) { return best_of(sides_[0], sides_[1], column); }
  std::uint8_t right_based(int column) { return best_of(sides_[1], sides_[0], across_ - 1 - column); }

 private:
  struct Side {
    std::vector<std::uint8_t> image;        // mirrored if it is the right one; padded
    std::vector<std::int64_t> column_sums;  // over the rows of the windows: pixels, then squares
    std::vector<double> sums;               // [window]: of its pixels
    std::vector<std::int64_t> variances;
    std::vector<double> inverses;  // 1 / variance
    // Products with the candidates on the other side.
    SimdArray<std::int32_t> columns;  // [column][candidate]: of the pixels, summed over the rows
    std::vector<int> column_rows;     // the row of windows that `columns` belongs to
    SimdArray<std::int32_t> window;   // [candidate]: of the columns begin..end-1, at most `window_`
    int begin = 0;
    int end = 0;
  };

  void move_sums(Side& side, int row);
  void enter_column(Side& own, const Side& other);
  std::uint8_t best_of(Side& own, const Side& other, int column);

  int width_;
  int height_;
  int window_;
  int disparities_;
  int across_;  // windows in a row
  int lanes_;
  const Simd& simd_;
  int row_ = 0;
  std::array<Side, 2> sides_;
  SimdArray<std::int32_t> no_column_;
  std::vector<const std::uint8_t*> rows_;
  std::vector<std::int16_t> own_pixels_;
  std::vector<double> quotients_;
};

}  // namespace stereotlm::kernels
