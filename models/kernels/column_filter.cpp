#include "models/kernels/column_filter.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>

namespace stereotlm::kernels {
namespace {

constexpr std::size_t kColumnsBetweenMoves = 64;
static_assert(kMostRows % kFilterBlock == 0);

// Copies at least `count` values, in whole blocks. Both arrays must have room for these.
void copy_blocks(const float* from, int count, float* to) {
  for (int e = 0; e < count; e += kFilterBlock) std::memcpy(to + e, from + e, kFilterBlock * sizeof(float));
}

}  // namespace

ColumnFilter::ColumnFilter(int width, int height, int rows_per_column,
                           const std::optional<FilterKernel>& kernel, const Simd& simd)
    : simd_(simd.column), width_(width), height_(height), rows_per_column_(rows_per_column), kernel_(kernel) {
  if (width < 1 || height < 1) {
    throw std::invalid_argument("image = " + std::to_string(width) + " x " + std::to_string(height) +
                                ": must have pixels");
  }
  IntegerRule{1, kMostRows}.required("rows_per_column", rows_per_column);
  if (kernel_) {
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
    const auto size = static_cast<std::size_t>(kernel_->size);
    line_stride_ = static_cast<std::size_t>(padded_rows(2 * half_));
    line_values_.resize(static_cast<std::size_t>(width_) * line_stride_);
    line_valid_.resize(static_cast<std::size_t>(width_));
    // The filter loops read beyond the last row, and copies of whole blocks write there.
    stride_ = line_stride_ + static_cast<std::size_t>(padded_rows(rows_per_column_));
    columns_.resize((kColumnsBetweenMoves + size - 1) * stride_);
    columns_valid_.resize(kColumnsBetweenMoves + size - 1);
    repeated_.resize(size * stride_);
  }
  start_frame(0);
}

void ColumnFilter::start_frame(int first_row) {
  first_row_ = first_row;
  column_ = -1;
  k_ = rows_per_column_;
  column_count_ = 0;
  position_ = kernel_ ? static_cast<std::size_t>(kernel_->size) - 2 : 0;
}

void ColumnFilter::begin_column() {
  k_ = 0;
  entered_valid_ = 0;
  if (++column_ == width_) {
    column_ = 0;
    ++first_row_;
  }
  if (!kernel_) return;
  if (++position_ == columns_valid_.size()) {
    const auto kept = static_cast<std::size_t>(kernel_->size) - 1;
    std::copy(columns_.end() - static_cast<std::ptrdiff_t>(kept * stride_), columns_.end(), columns_.begin());
    std::copy(columns_valid_.end() - static_cast<std::ptrdiff_t>(kept), columns_valid_.end(),
              columns_valid_.begin());
    position_ = kept;
  }
  float* const column = column_at(position_);
  copy_blocks(line_values_.data() + static_cast<std::size_t>(column_) * line_stride_, 2 * half_, column);
  entered_ = column + 2 * half_;
}

void ColumnFilter::finish_column() {
  if (!kernel_) {
    output_.valid = static_cast<std::uint32_t>(entered_valid_);
    return;
  }
  std::uint64_t& line_valid = line_valid_[static_cast<std::size_t>(column_)];
  std::uint64_t& valid = columns_valid_[position_];
  valid = line_valid | entered_valid_ << (2 * half_);
  repeat_edges();
  // The next strip lies one row further down: the 2h rows above it begin at row 1 of this column.
  copy_blocks(column_at(position_) + 1, 2 * half_,
              line_values_.data() + static_cast<std::size_t>(column_) * line_stride_);
  line_valid = valid >> 1U & ((std::uint64_t{1} << (2 * half_)) - 1);
  if (column_count_ >= static_cast<std::uint64_t>(half_)) leave();
  ++column_count_;
}

// Rows outside the image take the values of its first or last row.
void ColumnFilter::repeat_edges() {
  if (first_row_ <= 0) std::fill_n(entered_ - 2 * half_, 2 * half_ - first_row_, entered_[-first_row_]);
  // `last` is the k of the last row of the image; it is negative if that row entered with an earlier strip.
  // Once that row has left the column, the oldest row of the column holds its value.
  const int last = std::max(height_ - 1 - first_row_, -2 * half_);
  if (last < rows_per_column_ - 1) {
    std::fill_n(entered_ + last + 1, rows_per_column_ - 1 - last, entered_[last]);
  }
}

void ColumnFilter::leave() {
  const auto half = static_cast<std::size_t>(half_);
  const std::size_t centre_position = position_ - half;
  const int centre = column_ >= half_
                         ? column_ - half_
                         : static_cast<int>((column_count_ - half) % static_cast<std::uint64_t>(width_));
  const float* const columns = columns_around(centre, centre_position);
  output_.valid = static_cast<std::uint32_t>(columns_valid_[centre_position] >> half);
  if (wide_) {
    filter_wide(columns);
  } else {
    simd_.filter_column(columns, static_cast<std::ptrdiff_t>(stride_), weights_.data(), kernel_->size,
                        rows_per_column_, kernel_->shift, output_.values.data());
  }
}

// Returns the columns centre - h .. centre + h of the image, one stride apart. Columns beyond the edges
// repeat the edge.
const float* ColumnFilter::columns_around(int centre, std::size_t centre_position) {
  if (centre >= half_ && centre + half_ < width_) {
    return column_at(centre_position - static_cast<std::size_t>(half_));
  }
  float* to = repeated_.data();
  for (int i = -half_; i <= half_; ++i, to += stride_) {
    const int offset = std::clamp(centre + i, 0, width_ - 1) - centre;
    std::copy_n(column_at(centre_position) + offset * static_cast<std::ptrdiff_t>(stride_), stride_, to);
  }
  return repeated_.data();
}

void ColumnFilter::filter_wide(const float* columns) {
  for (int k = 0; k < rows_per_column_; ++k) {
    std::int64_t sum = 0;
    for (int i = 0; i < kernel_->size; ++i) {
      const float* const column = columns + static_cast<std::ptrdiff_t>(stride_) * i;
      for (int j = 0; j < kernel_->size; ++j) {
        sum += static_cast<std::int64_t>(column[k + j]) * kernel_->weight(i, j);
      }
    }
    // An arithmetic shift is the floor of the quotient.
    const std::int64_t level = 128 + (sum >> kernel_->shift);
    output_.values[static_cast<std::size_t>(k)] =
        static_cast<std::uint8_t>(std::clamp<std::int64_t>(level, 0, 255));
  }
}

}  // namespace stereotlm::kernels
