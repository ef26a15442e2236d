#include "models/kernels/column_filter.h"

#include <algorithm>
#include <cstddef>

namespace stereotlm::kernels {

ColumnFilter::ColumnFilter(int width, int height, int rows_per_column, int rows_per_strip,
                           const std::optional<FilterKernel>& kernel, const Simd& simd)
    : simd_(simd),
      rows_per_column_(rows_per_column),
      kernel_(kernel),
      pixels_(width, height, rows_per_column, rows_per_strip, kernel ? kernel->half() : 0),
      output_(static_cast<std::size_t>(padded_rows(rows_per_column))) {
  if (kernel_) {
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
  }
  start_frame(0);
}

void ColumnFilter::start_frame(int first_row) {
  pixels_.start_frame(first_row);
  k_ = rows_per_column_;
}

void ColumnFilter::begin_column() {
  k_ = 0;
  entered_valid_ = 0;
  if (kernel_) entered_ = pixels_.begin_column();
}

void ColumnFilter::finish_column() {
  if (!kernel_) {
    output_valid_ = entered_valid_;
    return;
  }
  if (!pixels_.finish_column(entered_valid_)) return;
  const float* const columns = pixels_.columns();
  output_valid_ = pixels_.valid();
  if (wide_) {
    filter_wide(columns);
  } else {
    simd_.filter_column(columns, pixels_.stride(), weights_.data(), kernel_->size, rows_per_column_,
                        kernel_->shift, output_.data());
  }
}

void ColumnFilter::filter_wide(const float* columns) {
  for (int k = 0; k < rows_per_column_; ++k) {
    std::int64_t sum = 0;
    for (int i = 0; i < kernel_->size; ++i) {
      const float* const column = columns + pixels_.stride() * i;
      for (int j = 0; j < kernel_->size; ++j) {
        sum += static_cast<std::int64_t>(column[k + j]) * kernel_->weight(i, j);
      }
    }
    // An arithmetic shift is the floor of the quotient.
    const std::int64_t level = 128 + (sum >> kernel_->shift);
    output_[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(std::clamp<std::int64_t>(level, 0, 255));
  }
}

}  // namespace stereotlm::kernels
