#include "models/kernels/correlation_matcher.h"

#include <algorithm>
#include <cstddef>

namespace stereotlm::kernels {

CorrelationMatcher::CorrelationMatcher(int width, int height, int window, int disparities, const Simd& simd)
    : width_(width),
      height_(height),
      window_(window),
      disparities_(disparities),
      across_(width - window + 1),
      lanes_(padded_lanes(disparities)),
      simd_(simd),
      window_products_(lanes_),
      no_column_(lanes_),
      rows_(static_cast<std::size_t>(window + 1)),
      own_pixels_(static_cast<std::size_t>(window + 1)),
      quotients_(static_cast<std::size_t>(lanes_)) {
  const auto windows = static_cast<std::size_t>(across_ + kLanePadding);
  for (Side& side : sides_) {
    side.image.resize(static_cast<std::size_t>(std::ptrdiff_t{width} * height + lanes_));
    side.sums.resize(windows);
    side.variances.resize(windows);
    side.inverses.resize(windows);
    side.products = SimdArray<std::int32_t>(std::ptrdiff_t{width} * lanes_);
  }
}

void CorrelationMatcher::run(const std::uint8_t* left, const std::uint8_t* right,
                             std::uint8_t* left_disparity, std::uint8_t* right_disparity) {
  std::copy_n(left, std::ptrdiff_t{width_} * height_, sides_[0].image.begin());
  for (std::ptrdiff_t begin = 0; begin < std::ptrdiff_t{width_} * height_; begin += width_)
    std::reverse_copy(right + begin, right + begin + width_, sides_[1].image.begin() + begin);
  for (Side& side : sides_) {
    side.column_sums.assign(static_cast<std::size_t>(width_), {});
    side.products.fill(0);
  }
  const int radius = window_ / 2;
  for (int row = 0; row + window_ <= height_; ++row) {
    for (Side& side : sides_) move_sums(side, row);
    const std::ptrdiff_t first = (std::ptrdiff_t{row} + radius) * width_ + radius;
    match_row(sides_[0], sides_[1], row, left_disparity + first, 1);
    if (right_disparity != nullptr)
      match_row(sides_[1], sides_[0], row, right_disparity + first + across_ - 1, -1);
  }
}

// The windows of `row` follow those of the row above it. The first row is 0.
void CorrelationMatcher::move_sums(Side& side, int row) const {
  const auto add = [&](int image_row, int sign) {
    const std::uint8_t* pixel = side.image.data() + std::ptrdiff_t{image_row} * width_;
    for (PixelSums& column : side.column_sums) {
      column.pixels += sign * *pixel;
      column.squares += sign * *pixel * *pixel;
      ++pixel;
    }
  };
  for (int entering = row == 0 ? 0 : row + window_ - 1; entering < row + window_; ++entering)
    add(entering, 1);
  if (row > 0) add(row - 1, -1);

  PixelSums sums;
  for (std::size_t u = 0; u < side.column_sums.size(); ++u) {
    sums.pixels += side.column_sums[u].pixels;
    sums.squares += side.column_sums[u].squares;
    if (u + 1 < static_cast<std::size_t>(window_)) continue;
    const std::size_t first = u + 1 - static_cast<std::size_t>(window_);
    side.sums[first] = static_cast<double>(sums.pixels);
    side.variances[first] = sums.variance(std::int64_t{window_} * window_);
    side.inverses[first] = 1 / static_cast<double>(side.variances[first]);
    sums.pixels -= side.column_sums[first].pixels;
    sums.squares -= side.column_sums[first].squares;
  }
}

// Moves the products of a column to `row`, adds them to those of the window, and removes those of the column
// that leaves the window.
void CorrelationMatcher::add_products(Side& own, const Side& other, int row, int column) {
  std::size_t count = 0;
  const auto add_row = [&](int image_row, int sign) {
    const std::ptrdiff_t begin = std::ptrdiff_t{image_row} * width_;
    rows_[count] = other.image.data() + begin + width_ - 1 - column;
    own_pixels_[count++] =
        static_cast<std::int16_t>(sign * own.image[static_cast<std::size_t>(begin + column)]);
  };
  if (row == 0) {
    for (int entering = 0; entering < window_; ++entering) add_row(entering, 1);
    add_row(0, 0);  // rows are added in pairs, and a window has an odd number
  } else {
    add_row(row + window_ - 1, 1);
    add_row(row - 1, -1);
  }
  std::int32_t* const products = own.products.data() + std::ptrdiff_t{column} * lanes_;
  simd_.add_products(rows_.data(), own_pixels_.data(), static_cast<int>(count / 2), lanes_, products,
                     column < window_ ? no_column_.data() : products - std::ptrdiff_t{window_} * lanes_,
                     window_products_.data());
}

// `disparity`: of the first window; `step`: from there to that of the next.
void CorrelationMatcher::match_row(Side& own, const Side& other, int row, std::uint8_t* disparity, int step) {
  window_products_.fill(0);
  for (int column = 0; column < width_; ++column) {
    add_products(own, other, row, column);
    const int begin = column - window_ + 1;  // of the window that ends at this column
    if (begin < 0) continue;
    const auto first = static_cast<std::size_t>(across_ - 1 - begin);
    const Candidates candidates{std::min(disparities_, begin + 1), other.sums.data() + first,
                                other.variances.data() + first, other.inverses.data() + first};
    const double sum = own.sums[static_cast<std::size_t>(begin)];
    disparity[std::ptrdiff_t{begin} * step] = static_cast<std::uint8_t>(
        simd_.best_candidate(candidates, window_products_.data(), window_ * window_, sum, quotients_.data()));
  }
}

}  // namespace stereotlm::kernels
