#include "models/kernels/correlation_search.h"

#include <algorithm>

namespace stereotlm::kernels {
namespace {

constexpr int kNoRow = -2;  // far from every row

}  // namespace

CorrelationSearch::CorrelationSearch(int width, int window, int disparities, const Simd& simd)
    : width_(width),
      window_(window),
      disparities_(disparities),
      windows_across_(width - window + 1),
      lanes_(padded_lanes(disparities)),
      simd_(simd.correlation),
      left_windows_(windows_of(left_, right_)),
      right_windows_(windows_of(right_, left_)),
      no_column_(disparities),
      rows_(static_cast<std::size_t>(window + 1)),
      own_pixels_(static_cast<std::size_t>(window + 1)),
      quotients_(static_cast<std::size_t>(lanes_)) {
  right_.is_reversed = true;
  const auto columns = static_cast<std::size_t>(width);
  const auto across = static_cast<std::size_t>(windows_across_);
  for (Side* side : {&left_, &right_}) {
    side->rows.resize(place_of_row(window) + columns + static_cast<std::size_t>(lanes_));
    side->column_pixels.resize(columns);
    side->column_squares.resize(columns);
    side->sums.resize(across + kLanePadding);
    side->variances.resize(across + kLanePadding);
    side->inverses.resize(across + kLanePadding);
  }
}

CorrelationSearch::Windows CorrelationSearch::windows_of(const Side& own, const Side& other) const {
  return {own, other, LaneArray<std::int32_t>(width_ * lanes_),
          std::vector<int>(static_cast<std::size_t>(width_)), LaneArray<std::int32_t>(lanes_)};
}

void CorrelationSearch::set_images(const std::uint8_t* left, const std::uint8_t* right) {
  left_.image = left;
  right_.image = right;
  row_ = kNoRow - window_;
  next_row_ = 0;
  for (Windows* windows : {&left_windows_, &right_windows_})
    std::fill(windows->column_rows.begin(), windows->column_rows.end(), kNoRow);
}

void CorrelationSearch::set_row(int row) {
  for (next_row_ = std::max(next_row_, row - 1); next_row_ < row + window_; ++next_row_) {
    for (Side* side : {&left_, &right_}) copy_row(*side, next_row_);
  }
  for (Side* side : {&left_, &right_}) {
    move_sums(*side, row);
    add_up(*side);
  }
  for (Windows* windows : {&left_windows_, &right_windows_}) windows->end = 0;
  row_ = row;
}

// Where a row of an image begins in Side::rows.
std::size_t CorrelationSearch::place_of_row(int row) const {
  return static_cast<std::size_t>(row % (window_ + 1)) * static_cast<std::size_t>(width_ + lanes_);
}

// The place of a window in the order of candidates.
std::size_t CorrelationSearch::place_of_window(const Side& side, int column) const {
  return static_cast<std::size_t>(side.is_reversed ? windows_across_ - 1 - column : column);
}

void CorrelationSearch::copy_row(Side& side, int row) {
  const std::uint8_t* const pixels = side.image + std::ptrdiff_t{row} * width_;
  std::uint8_t* const to = side.rows.data() + place_of_row(row);
  if (side.is_reversed) {
    std::reverse_copy(pixels, pixels + width_, to);
  } else {
    std::copy_n(pixels, width_, to);
  }
}

// Moves the column sums from row_ to `row`.
void CorrelationSearch::move_sums(Side& side, int row) {
  const auto add = [&](int image_row, int sign) {
    const std::uint8_t* const pixels = side.image + std::ptrdiff_t{image_row} * width_;
    for (std::size_t u = 0; u < side.column_pixels.size(); ++u) {
      side.column_pixels[u] += sign * pixels[u];
      side.column_squares[u] += sign * pixels[u] * pixels[u];
    }
  };
  int entering = row_ + window_;
  if (row >= entering) {
    std::fill(side.column_pixels.begin(), side.column_pixels.end(), 0);
    std::fill(side.column_squares.begin(), side.column_squares.end(), 0);
    entering = row;
  } else {
    for (int leaving = row_; leaving < row; ++leaving) add(leaving, -1);
  }
  for (; entering < row + window_; ++entering) add(entering, 1);
}

void CorrelationSearch::add_up(Side& side) {
  const std::int64_t pixels = std::int64_t{window_} * window_;
  PixelSums sums;
  const auto enter = [&](int column, int sign) {
    sums.pixels += sign * side.column_pixels[static_cast<std::size_t>(column)];
    sums.squares += sign * side.column_squares[static_cast<std::size_t>(column)];
  };
  for (int u = 0; u < window_ - 1; ++u) enter(u, 1);
  for (int column = 0; column < windows_across_; ++column) {
    enter(column + window_ - 1, 1);
    const std::size_t place = place_of_window(side, column);
    side.sums[place] = static_cast<double>(sums.pixels);
    side.variances[place] = sums.variance(pixels);
    side.inverses[place] = 1 / static_cast<double>(side.variances[place]);
    enter(column, -1);
  }
}

// Adds the column at windows.end to the sums, and removes the one that leaves the window.
void CorrelationSearch::enter_column(Windows& windows) {
  const int column = windows.end++;
  std::int32_t* const products = windows.columns.data() + std::ptrdiff_t{column} * lanes_;
  const int leaving = column - window_;
  const int at = windows.other.is_reversed ? width_ - 1 - column : column;
  std::size_t count = 0;
  const auto add_row = [&](int row, int sign) {
    rows_[count] = windows.other.rows.data() + place_of_row(row) + at;
    own_pixels_[count++] =
        static_cast<std::int16_t>(sign * windows.own.image[std::ptrdiff_t{row} * width_ + column]);
  };
  int& row_of_products = windows.column_rows[static_cast<std::size_t>(column)];
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
      leaving < windows.begin ? no_column_.data() : products - std::ptrdiff_t{window_} * lanes_,
      windows.sums.data());
}

// `most`: the candidates inside the image.
std::uint8_t CorrelationSearch::best_of(Windows& windows, int column, int most) {
  if (column >= windows.end) {
    windows.begin = windows.end = column;
    windows.sums.fill(0);
  }
  while (windows.end < column + window_) enter_column(windows);

  const Side& other = windows.other;
  const std::size_t first = place_of_window(other, column);
  const Candidates candidates{std::min(disparities_, most), other.sums.data() + first,
                              other.variances.data() + first, other.inverses.data() + first};
  const double own_sum = windows.own.sums[place_of_window(windows.own, column)];
  return static_cast<std::uint8_t>(
      simd_.best_candidate(candidates, windows.sums.data(), window_ * window_, own_sum, quotients_.data()));
}

}  // namespace stereotlm::kernels
