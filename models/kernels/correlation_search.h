#pragma once

#include <cstdint>
#include <vector>

#include "models/kernels/correlation.h"

namespace stereotlm::kernels {

// Finds the best candidates of single windows by the cost `zncc`, with exact fractions; used by ImageMatcher
// for windows that the vector loops leave undecided.
class CorrelationSearch {
 public:
  // Images of `width` columns.
  CorrelationSearch(int width, int window, int disparities);

  // Sets the images, and the row at which the windows begin.
  void set_row(const std::uint8_t* left, const std::uint8_t* right, int top_row);
  // The disparity of the window that begins at this column.
  std::uint8_t left_based(int column);
  std::uint8_t right_based(int column);

 private:
  struct Side {
    const std::uint8_t* top_row = nullptr;
    std::vector<PixelSums> windows;  // [column]
  };

  void add_up(Side& side);
  // The best of the disparities 0..count-1. Disparity d means the window of `other` at column + step * d.
  std::uint8_t best_of(const Side& own, int column, const Side& other, int step, int count);

  int width_;
  int window_;
  int disparities_;
  int windows_across_;
  Side left_;
  Side right_;
  std::vector<std::int32_t> column_pixels_;
  std::vector<std::int32_t> column_squares_;
  std::vector<std::int32_t> products_;  // [candidate]
};

}  // namespace stereotlm::kernels
