#include "models/kernels/column_filter.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "models/kernels/vector_loops.h"

namespace stereotlm::kernels {
namespace {

constexpr std::uint64_t one_bit(int position, bool value) { return std::uint64_t{value} << position; }

}  // namespace

ColumnFilter::ColumnFilter(int width, int height, int rows_per_column,
                           const std::optional<FilterKernel>& kernel)
    : width_(width), height_(height), rows_per_column_(rows_per_column), kernel_(kernel) {
  if (!kernel_) return;
  if (const auto found = problems(*kernel_); !found.empty()) throw std::invalid_argument(found.front());
  half_ = kernel_->half();
  std::int64_t positive = 0;
  for (int column = 0; column < kernel_->size; ++column) {
    for (int row = 0; row < kernel_->size; ++row) {
      const int weight = kernel_->weight(column, row);
      weights_.push_back(static_cast<float>(weight));
      positive += std::max(weight, 0);
    }
  }
  // The weights sum to 0, so that every partial sum lies in -255 * positive .. 255 * positive.
  wide_ = positive * 255 > (1 << 24);
  line_values_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(2 * half_));
  line_valid_.resize(static_cast<std::size_t>(width_));
}

void ColumnFilter::start_frame(int first_row) {
  first_row_ = first_row;
  column_ = 0;
  k_ = 0;
  column_count_ = 0;
}

void ColumnFilter::finish_column() {
  entered_.valid = 0;
  for (int k = 0; k < rows_per_column_; ++k) {
    entered_.valid |= static_cast<std::uint32_t>(one_bit(k, entered_valid_[static_cast<std::size_t>(k)]));
  }
  if (!kernel_) {
    output_ = entered_;
    return;
  }
  Column& column = ring_[column_count_ % kRing];
  float* line_values = line_values_.data() + static_cast<std::ptrdiff_t>(column_) * 2 * half_;
  std::uint64_t& line_valid = line_valid_[static_cast<std::size_t>(column_)];
  for (int e = 0; e < 2 * half_; ++e) column.values[static_cast<std::size_t>(e)] = line_values[e];
  column.valid = line_valid | std::uint64_t{entered_.valid} << (2 * half_);
  enter(column);
  leave();
  // Of the 2h + rows_per_column rows in this column the next strip, one row down, starts with those from 1
  // on.
  for (int e = 0; e < 2 * half_; ++e) line_values[e] = column.values[static_cast<std::size_t>(e) + 1];
  line_valid = column.valid >> 1U & (one_bit(2 * half_, true) - 1);
  ++column_count_;
  if (++column_ == width_) {
    column_ = 0;
    ++first_row_;
  }
}

// Puts the new rows below the old ones, with the edge rows repeated beyond the image.
void ColumnFilter::enter(Column& column) const {
  float* rows = column.values.data() + 2 * half_;
  for (int k = 0; k < rows_per_column_; ++k)
    rows[k] = static_cast<float>(entered_.values[static_cast<std::size_t>(k)]);
  if (first_row_ <= 0) std::fill_n(column.values.data(), 2 * half_ - first_row_, rows[-first_row_]);
  // k of the last row of the image, negative for an old row; so far below the image that it has left the
  // column, the oldest row repeats it.
  const int last = std::max(height_ - 1 - first_row_, -2 * half_);
  if (last < rows_per_column_ - 1) std::fill_n(rows + last + 1, rows_per_column_ - 1 - last, rows[last]);
}

void ColumnFilter::leave() {
  if (column_count_ < static_cast<std::uint64_t>(half_)) return;
  // The columns around the centre, h columns back, clamped to the strip that the centre lies in.
  const std::uint64_t centre_count = column_count_ - static_cast<std::uint64_t>(half_);
  const int centre = column_ >= half_ ? column_ - half_
                                      : static_cast<int>(centre_count % static_cast<std::uint64_t>(width_));
  std::array<const float*, kRing> taps;  // [i + h]
  const bool inside = centre >= half_ && centre + half_ < width_;
  for (int i = -half_; i <= half_; ++i) {
    const int offset = inside ? i : std::clamp(centre + i, 0, width_ - 1) - centre;
    taps[static_cast<std::size_t>(i + half_)] =
        ring_[(centre_count + static_cast<std::uint64_t>(offset)) % kRing].values.data();
  }
  output_.valid = static_cast<std::uint32_t>(ring_[centre_count % kRing].valid >> half_);
  if (wide_) {
    filter_wide(taps.data());
  } else {
    filter_column(taps.data(), weights_.data(), kernel_->size, rows_per_column_, kernel_->shift,
                  output_.values.data());
  }
}

void ColumnFilter::filter_wide(const float* const* taps) {
  for (int k = 0; k < rows_per_column_; ++k) {
    std::int64_t sum = 0;
    for (int i = 0; i < kernel_->size; ++i) {
      for (int j = 0; j < kernel_->size; ++j) {
        sum += static_cast<std::int64_t>(taps[i][k + j]) * kernel_->weight(i, j);
      }
    }
    // An arithmetic shift is the floor of the quotient.
    const std::int64_t level = 128 + (sum >> kernel_->shift);
    output_.values[static_cast<std::size_t>(k)] =
        static_cast<std::uint8_t>(std::clamp<std::int64_t>(level, 0, 255));
  }
}

}  // namespace stereotlm::kernels
