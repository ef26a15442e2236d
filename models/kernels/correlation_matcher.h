#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/kernels/correlation.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Matches image pairs by the cost `zncc`, with exact fractions (contract 7.6); used by ImageMatcher. Sums of
// products are kept from column to column and from row to row, so that a window costs little more than the
// comparison of its candidates.
//
// The right image is mirrored, so that both sides do the same: the candidates of the window at column u are
// the windows of the other image at columns a, a + 1, .., where a = (width - window) - u.
class CorrelationMatcher {
 public:
  // The image has at least one window.
  CorrelationMatcher(int width, int height, int window, int disparities, const Simd& simd);
  // As ImageMatcher::run(). Without `right_disparity` only the left side is matched.
  void run(const std::uint8_t* left, const std::uint8_t* right, std::uint8_t* left_disparity,
           std::uint8_t* right_disparity);

 private:
  struct Side {
    std::vector<std::uint8_t> image;      // mirrored if it is the right one; padded
    std::vector<PixelSums> column_sums;   // over the rows of the windows
    std::vector<double> sums;             // [window]: of its pixels
    std::vector<std::int64_t> variances;  // [window]
    std::vector<double> inverses;         // [window]: 1 / variance
    SimdArray<std::int32_t> products;     // [column][candidate]: of the pixels, summed over the rows
  };

  void move_sums(Side& side, int row) const;
  void add_products(Side& own, const Side& other, int row, int column);
  void match_row(Side& own, const Side& other, int row, std::uint8_t* disparity, int step);

  int width_;
  int height_;
  int window_;
  int disparities_;
  int across_;  // windows in a row
  int lanes_;   // candidates of a column, padded
  const Simd& simd_;
  std::array<Side, 2> sides_;
  SimdArray<std::int32_t> window_products_;  // [candidate]: of the columns of a window
  SimdArray<std::int32_t> no_column_;        // zeros
  std::vector<const std::uint8_t*> rows_;    // arguments of Simd::add_products, and of best_candidate
  std::vector<std::int16_t> own_pixels_;
  std::vector<double> quotients_;
};

}  // namespace stereotlm::kernels
