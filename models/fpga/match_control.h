#pragma once

#include <algorithm>
#include <cstdint>

#include "models/fpga/frame_geometry.h"

namespace stereotlm::fpga {

// Decides when the matcher consumes slots, and which of its cycles completes a word of results.
class MatchControl {
 public:
  explicit MatchControl(const FrameGeometry& geometry) : geometry_(geometry) {}

  void start_frame() {
    slots_left_ = geometry_.slots;
    drain_left_ = geometry_.drain_cycles;
    k_ = 0;
    columns_ = 0;
  }
  // After the last slot the matcher consumes the columns of the drain, which need no slots.
  bool draining() const { return slots_left_ == 0; }
  // Whether the matcher consumes in this cycle.
  bool decide(bool slots_ready, bool result_queue_has_room) const {
    return result_queue_has_room && (draining() ? drain_left_ > 0 : slots_ready);
  }
  // Consumes a slot, or a cycle of the drain. Returns true if this completes a group of four columns. Groups
  // are counted from column result_delay_columns % 4 on.
  bool consume() {
    --(draining() ? drain_left_ : slots_left_);
    if (++k_ < geometry_.slots_per_column) return false;
    k_ = 0;
    ++columns_;
    return (columns_ - geometry_.result_delay_columns) % 4 == 0;
  }
  // Whether the group of four columns completes a word of results. To be called when consume() has returned
  // true. The column just consumed is number columns_ - 1, so columns_ - result_delay_columns results have
  // left.
  bool word_leaves() const { return columns_ > geometry_.result_delay_columns; }

  // The matcher's part of the state that determines the next cycles. To be called between two columns.
  std::uint64_t state() const {
    return std::uint64_t{columns_ >= geometry_.result_delay_columns} | std::uint64_t{draining()} << 1U;
  }
  std::uint64_t columns() const { return columns_; }
  // The number of words of results that have left in this frame.
  std::uint64_t words() const {
    return columns_ > geometry_.result_delay_columns ? (columns_ - geometry_.result_delay_columns) / 4 : 0;
  }
  // The number of columns up to and including the one after which state() changes. To be called between two
  // columns.
  std::uint64_t uniform_columns() const {
    const auto slots_per_column = static_cast<std::uint64_t>(geometry_.slots_per_column);
    const std::uint64_t left = (draining() ? drain_left_ : slots_left_) / slots_per_column;
    if (columns_ >= geometry_.result_delay_columns) return left;
    return std::min(left, geometry_.result_delay_columns - columns_);
  }
  // Skips columns, at most uniform_columns().
  void skip_columns(std::uint64_t columns) {
    (draining() ? drain_left_ : slots_left_) -=
        columns * static_cast<std::uint64_t>(geometry_.slots_per_column);
    columns_ += columns;
  }
  // The number of cycles of the frame in which the matcher has still to consume.
  std::uint64_t cycles_left() const { return slots_left_ + drain_left_; }

 private:
  FrameGeometry geometry_;
  std::uint64_t slots_left_ = 0;
  std::uint64_t drain_left_ = 0;
  int k_ = 0;                  // slots of the current column that have been consumed
  std::uint64_t columns_ = 0;  // columns consumed
};

}  // namespace stereotlm::fpga
