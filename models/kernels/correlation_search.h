#pragma once

#include <algorithm>
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
// The right image is mirrored, so that both sides do the same: the candidates of the window at column u are
// the windows of the other image at columns a, a + 1, .., where a = (width - window) - u.
class CorrelationSearch {
 public:
  CorrelationSearch(int width, int height, int window, int disparities, const Simd& simd)
      : width_(width),
        height_(height),
        window_(window),
        disparities_(disparities),
        across_(width - window + 1),
        lanes_(padded_lanes(disparities)),
        simd_(simd),
        no_column_(disparities),
        rows_(static_cast<std::size_t>(window + 1)),
        own_pixels_(static_cast<std::size_t>(window + 1)),
        quotients_(static_cast<std::size_t>(lanes_)) {
    const auto columns = static_cast<std::size_t>(width);
    const auto windows = static_cast<std::size_t>(across_ + kLanePadding);
    for (ImageSums& side : sides_) {
      side.image.resize(columns * static_cast<std::size_t>(height) + static_cast<std::size_t>(lanes_));
      side.column_sums.resize(2 * columns);
      side.sums.resize(windows);
      side.variances.resize(windows);
      side.inverses.resize(windows);
      side.columns = SimdArray<std::int32_t>(width * lanes_);
      side.column_rows.resize(columns);
      side.window = SimdArray<std::int32_t>(lanes_);
    }
  }

  // Begins a pair of images.
  void set_images(const std::uint8_t* left, const std::uint8_t* right) {
    std::copy_n(left, std::ptrdiff_t{width_} * height_, sides_[0].image.begin());
    for (int row = 0; row < height_; ++row, right += width_)
      std::reverse_copy(right, right + width_, sides_[1].image.begin() + std::ptrdiff_t{row} * width_);
    row_ = kNoRow - window_;
    for (ImageSums& side : sides_) std::fill(side.column_rows.begin(), side.column_rows.end(), kNoRow);
  }
  // Sets the row at which the windows begin: a later one than the last of this pair.
  void set_row(int row) {
    for (ImageSums& side : sides_) {
      move_sums(side, row);
      side.end = 0;
    }
    row_ = row;
  }
  // The disparity of the window that begins at this column. In a row the columns of the left image must
  // ascend, and those of the right image descend.
  std::uint8_t left_based(int column) { return best_of(sides_[0], sides_[1], column); }
  std::uint8_t right_based(int column) { return best_of(sides_[1], sides_[0], across_ - 1 - column); }

 private:
  static constexpr int kNoRow = -2;  // far from every row

  struct ImageSums {
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

  // Moves the sums of the columns from row_ to `row`, and adds up those of each window.
  void move_sums(ImageSums& side, int row) {
    const auto width = static_cast<std::size_t>(width_);
    std::int64_t* const pixels = side.column_sums.data();
    std::int64_t* const squares = pixels + width;
    const auto add = [&](int image_row, int sign) {
      const std::uint8_t* const from = side.image.data() + std::ptrdiff_t{image_row} * width_;
      for (std::size_t u = 0; u < width; ++u) {
        pixels[u] += sign * from[u];
        squares[u] += sign * from[u] * from[u];
      }
    };
    int entering = row_ + window_;
    if (row >= entering) {
      std::fill(side.column_sums.begin(), side.column_sums.end(), 0);
      entering = row;
    } else {
      for (int leaving = row_; leaving < row; ++leaving) add(leaving, -1);
    }
    for (; entering < row + window_; ++entering) add(entering, 1);

    PixelSums sums;
    for (std::size_t u = 0; u < width; ++u) {
      sums.pixels += pixels[u];
      sums.squares += squares[u];
      if (u + 1 < static_cast<std::size_t>(window_)) continue;
      const std::size_t first = u + 1 - static_cast<std::size_t>(window_);
      side.sums[first] = static_cast<double>(sums.pixels);
      side.variances[first] = sums.variance(std::int64_t{window_} * window_);
      side.inverses[first] = 1 / static_cast<double>(side.variances[first]);
      sums.pixels -= pixels[first];
      sums.squares -= squares[first];
    }
  }
  // Adds the column at own.end to the products of the window, and removes the one that leaves it.
  void enter_column(ImageSums& own, const ImageSums& other) {
    const int column = own.end++;
    std::int32_t* const products = own.columns.data() + std::ptrdiff_t{column} * lanes_;
    std::size_t count = 0;
    const auto add_row = [&](int row, int sign) {
      const std::ptrdiff_t begin = std::ptrdiff_t{row} * width_;
      rows_[count] = other.image.data() + begin + width_ - 1 - column;
      own_pixels_[count++] =
          static_cast<std::int16_t>(sign * own.image[static_cast<std::size_t>(begin + column)]);
    };
    int& row_of_products = own.column_rows[static_cast<std::size_t>(column)];
    if (row_of_products == row_ - 1) {
      add_row(row_ + window_ - 1, 1);
      add_row(row_ - 1, -1);
    } else {
      std::fill_n(products, lanes_, 0);
      for (int row = row_; row < row_ + window_; ++row) add_row(row, 1);
      add_row(row_, 0);
    }
    row_of_products = row_;
    simd_.add_products(
        rows_.data(), own_pixels_.data(), static_cast<int>(count / 2), lanes_, products,
        column - window_ < own.begin ? no_column_.data() : products - std::ptrdiff_t{window_} * lanes_,
        own.window.data());
  }
  std::uint8_t best_of(ImageSums& own, const ImageSums& other, int column) {
    if (column >= own.end) {
      own.begin = own.end = column;
      own.window.fill(0);
    }
    while (own.end < column + window_) enter_column(own, other);
    const auto first = static_cast<std::size_t>(across_ - 1 - column);
    const Candidates candidates{std::min(disparities_, column + 1), other.sums.data() + first,
                                other.variances.data() + first, other.inverses.data() + first};
    return static_cast<std::uint8_t>(simd_.best_candidate(candidates, own.window.data(), window_ * window_,
                                                          own.sums[static_cast<std::size_t>(column)],
                                                          quotients_.data()));
  }

  int width_;
  int height_;
  int window_;
  int disparities_;
  int across_;  // windows in a row
  int lanes_;
  const Simd& simd_;
  int row_ = 0;
  std::array<ImageSums, 2> sides_;
  SimdArray<std::int32_t> no_column_;
  std::vector<const std::uint8_t*> rows_;
  std::vector<std::int16_t> own_pixels_;
  std::vector<double> quotients_;
};

}  // namespace stereotlm::kernels
