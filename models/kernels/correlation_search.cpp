#include "models/kernels/correlation_search.h"

#include <algorithm>
#include <cstddef>

namespace stereotlm::kernels {

CorrelationSearch::CorrelationSearch(int width, int window, int disparities)
    : width_(width),
      window_(window),
      disparities_(disparities),
      windows_across_(width - window + 1),
      column_pixels_(static_cast<std::size_t>(width)),
      column_squares_(static_cast<std::size_t>(width)),
      products_(static_cast<std::size_t>(disparities)) {
  for (Side* side : {&left_, &right_}) side->windows.resize(static_cast<std::size_t>(windows_across_));
}

void CorrelationSearch::set_row(const std::uint8_t* left, const std::uint8_t* right, int top_row) {
  left_.top_row = left + std::ptrdiff_t{top_row} * width_;
  right_.top_row = right + std::ptrdiff_t{top_row} * width_;
  add_up(left_);
  add_up(right_);
}

void CorrelationSearch::add_up(Side& side) {
  std::fill(column_pixels_.begin(), column_pixels_.end(), 0);
  std::fill(column_squares_.begin(), column_squares_.end(), 0);
  for (int row = 0; row < window_; ++row) {
    const std::uint8_t* const pixels = side.top_row + std::ptrdiff_t{row} * width_;
    for (std::size_t u = 0; u < column_pixels_.size(); ++u) {
      column_pixels_[u] += pixels[u];
      column_squares_[u] += pixels[u] * pixels[u];
    }
  }
  PixelSums sums;
  const auto window = static_cast<std::size_t>(window_);
  for (std::size_t u = 0; u < column_pixels_.size(); ++u) {
    sums.pixels += column_pixels_[u];
    sums.squares += column_squares_[u];
    if (u + 1 < window) continue;
    side.windows[u + 1 - window] = sums;
    sums.pixels -= column_pixels_[u + 1 - window];
    sums.squares -= column_squares_[u + 1 - window];
  }
}

std::uint8_t CorrelationSearch::left_based(int column) {
  return best_of(left_, column, right_, -1, std::min(disparities_, column + 1));
}

std::uint8_t CorrelationSearch::right_based(int column) {
  return best_of(right_, column, left_, 1, std::min(disparities_, windows_across_ - column));
}

std::uint8_t CorrelationSearch::best_of(const Side& own, int column, const Side& other, int step, int count) {
  // The windows of the other side, in the order of their columns.
  const int first = step > 0 ? column : column - count + 1;
  std::int32_t* const products = products_.data();
  std::fill_n(products, count, 0);
  for (int row = 0; row < window_; ++row) {
    const std::ptrdiff_t begin = std::ptrdiff_t{row} * width_;
    for (int i = 0; i < window_; ++i) {
      const std::int32_t pixel = own.top_row[begin + column + i];
      const std::uint8_t* const others = other.top_row + begin + first + i;
      for (int c = 0; c < count; ++c) products[c] += pixel * others[c];
    }
  }
  const std::int64_t pixels = std::int64_t{window_} * window_;
  const PixelSums& own_sums = own.windows[static_cast<std::size_t>(column)];
  Correlation best;
  int best_disparity = 0;
  for (int d = 0; d < count; ++d) {
    const int at = column + step * d;
    const PixelSums& other_sums = other.windows[static_cast<std::size_t>(at)];
    const Correlation candidate{covariance(pixels, products[at - first], own_sums, other_sums),
                                other_sums.variance(pixels)};
    if (d > 0 && !is_greater(candidate, best)) continue;
    best = candidate;
    best_disparity = d;
  }
  return static_cast<std::uint8_t>(best_disparity);
}

}  // namespace stereotlm::kernels
