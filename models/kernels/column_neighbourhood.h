#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "models/kernels/pixel_column.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Holds the pixels around the columns of a frame, in the order in which the hardware fetches them. Columns
// enter strip by strip: columns 0..width-1, then those of the next strip, `rows_per_strip` rows below. A
// column has `rows_per_column` new rows; line memories give the 2h rows above (h is `half`). When column u
// enters, as many rows of column u - h leave, which lie h rows higher. columns() gives these pixels and h
// rows and columns on each side of them. Edge pixels replace what lies outside the image.
template <class Value>
class ColumnNeighbourhood {
 public:
  // The image is not empty; `rows_per_column` is 1..kMostRows.
  ColumnNeighbourhood(int width, int height, int rows_per_column, int rows_per_strip, int half)
      : width_(width), height_(height), rows_(rows_per_column), step_(rows_per_strip), half_(half) {
    const auto size = static_cast<std::size_t>(2 * half + 1);
    line_stride_ = static_cast<std::size_t>(padded_rows(2 * half_));
    line_values_.resize(static_cast<std::size_t>(width_) * line_stride_);
    line_valid_.resize(static_cast<std::size_t>(width_));
    // Padded, because ColumnFilter reads whole blocks of rows, and copy_blocks() writes them.
    stride_ = line_stride_ + static_cast<std::size_t>(padded_rows(rows_));
    columns_.resize((kColumnsBetweenMoves + size - 1) * stride_);
    columns_valid_.resize(kColumnsBetweenMoves + size - 1);
    repeated_.resize(size * stride_);
  }

  // Begins a frame. `first_row` is the image row of the first new row of column 0, and may be negative.
  void start_frame(int first_row) {
    first_row_ = first_row;
    column_ = -1;
    column_count_ = 0;
    position_ = static_cast<std::size_t>(2 * half_) - 1;
  }
  // Begins a column. Returns where its new rows are to be stored.
  Value* begin_column() {
    if (++column_ == width_) {
      column_ = 0;
      first_row_ += step_;
    }
    if (++position_ == columns_valid_.size()) {
      const auto kept = static_cast<std::size_t>(2 * half_);
      std::copy(columns_.end() - static_cast<std::ptrdiff_t>(kept * stride_), columns_.end(),
                columns_.begin());
      std::copy(columns_valid_.end() - static_cast<std::ptrdiff_t>(kept), columns_valid_.end(),
                columns_valid_.begin());
      position_ = kept;
    }
    Value* const column = column_at(position_);
    copy_blocks(line_values_.data() + static_cast<std::size_t>(column_) * line_stride_, column);
    entered_ = column + 2 * half_;
    return entered_;
  }
  // `entered_valid`: the valid bits of the new rows. Returns true if a column leaves.
  bool finish_column(std::uint64_t entered_valid) {
    std::uint64_t& line_valid = line_valid_[static_cast<std::size_t>(column_)];
    std::uint64_t& valid = columns_valid_[position_];
    valid = line_valid | entered_valid << half_;
    repeat_edges();
    // The next strip lies step_ rows further down, and with it the rows above it in this column.
    copy_blocks(column_at(position_) + step_,
                line_values_.data() + static_cast<std::size_t>(column_) * line_stride_);
    line_valid = valid >> step_ & ((std::uint64_t{1} << half_) - 1);
    return column_count_++ >= static_cast<std::uint64_t>(half_);
  }

  // The column that leaves with the last one, and its neighbours: 2h + 1 columns, stride() apart, of 2h +
  // rows_per_column rows.
  const Value* columns() {
    const std::size_t centre_position = position_ - static_cast<std::size_t>(half_);
    const int centre = column_ >= half_
                           ? column_ - half_
                           : static_cast<int>((column_count_ - 1 - static_cast<unsigned>(half_)) %
                                              static_cast<std::uint64_t>(width_));
    return columns_around(centre, centre_position);
  }
  std::ptrdiff_t stride() const { return static_cast<std::ptrdiff_t>(stride_); }
  // The valid bits of the rows that leave.
  std::uint64_t valid() const { return columns_valid_[position_ - static_cast<std::size_t>(half_)]; }

 private:
  static constexpr std::size_t kColumnsBetweenMoves = 64;

  // Copies the rows above the new ones, in whole blocks.
  void copy_blocks(const Value* from, Value* to) const {
    for (int e = 0; e < 2 * half_; e += kFilterBlock)
      std::memcpy(to + e, from + e, kFilterBlock * sizeof(Value));
  }

  // Rows outside the image take the values of its first or last row.
  void repeat_edges() {
    if (first_row_ <= 0 && -first_row_ < rows_)
      std::fill_n(entered_ - 2 * half_, 2 * half_ - first_row_, entered_[-first_row_]);
    // `last` is the k of the last row of the image; it is negative if that row entered with an earlier strip.
    // Once that row has left the column, the oldest row of the column holds its value.
    const int last = std::max(height_ - 1 - first_row_, -2 * half_);
    if (last < rows_ - 1) std::fill_n(entered_ + last + 1, rows_ - 1 - last, entered_[last]);
  }

  // Columns beyond the edges repeat the edge.
  const Value* columns_around(int centre, std::size_t centre_position) {
    if (centre >= half_ && centre + half_ < width_)
      return column_at(centre_position - static_cast<std::size_t>(half_));
    Value* to = repeated_.data();
    for (int i = -half_; i <= half_; ++i, to += stride_) {
      const int offset = std::clamp(centre + i, 0, width_ - 1) - centre;
      std::copy_n(column_at(centre_position) + offset * static_cast<std::ptrdiff_t>(stride_), stride_, to);
    }
    return repeated_.data();
  }
  Value* column_at(std::size_t position) { return columns_.data() + position * stride_; }

  int width_;
  int height_;
  int rows_;
  int step_;
  int half_;

  // Rows of a column are counted from its first new row, so the rows above it are negative. Values begin at
  // row -2h. Valid bits begin at row -h (bit 0), because only the rows that leave need one.
  //
  // Line memories: rows -2h .. -1 of each image column, padded to whole blocks.
  std::size_t line_stride_ = 0;
  std::vector<Value> line_values_;
  std::vector<std::uint64_t> line_valid_;
  // The columns that entered last, rows -2h .. rows_ - 1; the newest is at position_. When the memory is
  // full, the newest 2h columns move to its beginning.
  std::size_t stride_ = 0;
  std::vector<Value> columns_;
  std::vector<std::uint64_t> columns_valid_;
  std::vector<Value> repeated_;  // copies of the columns around a column near the left or right edge
  std::size_t position_ = 0;
  std::uint64_t column_count_ = 0;  // columns completed since the start of the frame

  int column_ = 0;     // image column of the column that entered last
  int first_row_ = 0;  // image row of its first new row
  Value* entered_ = nullptr;
};

}  // namespace stereotlm::kernels
