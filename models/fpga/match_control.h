#pragma once

#include <algorithm>
#include <cstdint>

#include "models/fpga/frame_geometry.h"
#include "models/kernels/pixel_column.h"

namespace stereotlm::fpga {

// Decides when the matcher works, and which of its cycles complete words of results. It works on a
// consume-cycle (contract 8.1; with one lane: a slot) for `folds` cycles. In the last of them it consumes the
// slots of the consume-cycle (contract 7.1). In the drain there are no slots.
class MatchControl {
 public:
  explicit MatchControl(const FrameGeometry& geometry) : geometry_(geometry) {}

  void start_frame() {
    worked_before_frame_ = worked();
    left_ = geometry_.consume_cycles;
    drain_left_ = geometry_.drain_cycles;
    fold_ = 0;
    cycle_of_column_ = 0;
    columns_ = 0;
  }
  bool draining() const { return left_ == 0; }
  // The number of lanes of each side, from lane 0 on, that have a slot for the consume-cycle which is next or
  // under way.
  int lanes() const {
    return std::min(geometry_.lanes, geometry_.slots_per_column - cycle_of_column_ * geometry_.lanes);
  }
  // Whether the matcher works in this cycle. The arguments matter only for the first cycle of a
  // consume-cycle.
  bool decide(bool slots_ready, bool result_queue_has_room) const {
    return fold_ != 0 || (result_queue_has_room && (draining() ? drain_left_ > 0 : slots_ready));
  }
  // Whether the matcher consumes in this cycle. To be called only if it works.
  bool consumes() const { return fold_ + 1 == geometry_.folds; }
  // Works for a cycle. Returns true if this completes a group of four columns. Groups are counted from column
  // result_delay_columns % 4 on.
  bool work() {
    if (++fold_ < geometry_.folds) return false;
    fold_ = 0;
    --(draining() ? drain_left_ : left_);
    if (++cycle_of_column_ < geometry_.cycles_per_column) return false;
    cycle_of_column_ = 0;
    ++columns_;
    return (columns_ - geometry_.result_delay_columns) % 4 == 0;
  }
  // The number of words of results that the group of four columns completes: one for each row of the strip
  // that lies inside the image. To be called when work() has returned true. The column just consumed is
  // number columns_ - 1.
  int words_leaving() const {
    if (columns_ <= geometry_.result_delay_columns) return 0;
    return columns_ <= geometry_.last_strip_column ? geometry_.rows : geometry_.last_rows;
  }

  // The matcher's part of the state that determines the next cycles: bits 0..2 the phase, bits 3
  // and 4 the columns of the group that are consumed, bits 5..10 cycle_of_column_, bits 11..18 fold_.
  std::uint64_t state() const {
    return phase() | (columns_ - geometry_.result_delay_columns) % 4 << 3U |
           static_cast<std::uint64_t>(cycle_of_column_) << 5U | static_cast<std::uint64_t>(fold_) << kFoldBit;
  }
  // The phase of the frame: before or after the first results, the last strip, the drain.
  std::uint64_t phase() const {
    return std::uint64_t{columns_ >= geometry_.result_delay_columns} | std::uint64_t{draining()} << 1U |
           std::uint64_t{columns_ >= fewer_rows_column_} << 2U;
  }
  std::uint64_t columns() const { return columns_; }
  // The number of words of results that have left in this frame.
  std::uint64_t words() const {
    if (columns_ <= geometry_.result_delay_columns) return 0;
    const std::uint64_t before_last_strip = std::min(columns_, geometry_.last_strip_column);
    return (before_last_strip - geometry_.result_delay_columns) / 4 *
               static_cast<std::uint64_t>(geometry_.rows) +
           (columns_ - before_last_strip) / 4 * static_cast<std::uint64_t>(geometry_.last_rows);
  }
  // The number of cycles for which the matcher still works on the consume-cycle that it has begun, before the
  // cycle in which it consumes.
  std::uint64_t cycles_to_consume() const {
    return fold_ == 0 ? 0 : static_cast<std::uint64_t>(geometry_.folds - 1 - fold_);
  }
  // Skips `cycles` of these cycles.
  void skip_folds(std::uint64_t cycles) { fold_ += static_cast<int>(cycles); }
  // The number of consume-cycles that have ended in this frame.
  std::uint64_t consumed() const {
    return columns_ * cycles_per_column() + static_cast<std::uint64_t>(cycle_of_column_);
  }
  // The number of consume-cycles to the end of the group.
  std::uint64_t cycles_of_group_left() const {
    const std::uint64_t columns = 4 - (columns_ - geometry_.result_delay_columns) % 4;
    return columns * cycles_per_column() - static_cast<std::uint64_t>(cycle_of_column_);
  }
  // Skips `consumed` consume-cycles. The matcher is in `state` afterwards.
  void set_state(std::uint64_t state, std::uint64_t consumed) {
    const std::uint64_t all = this->consumed() + consumed;
    left_ = geometry_.consume_cycles - std::min(all, geometry_.consume_cycles);
    drain_left_ = geometry_.consume_cycles + geometry_.drain_cycles - std::max(all, geometry_.consume_cycles);
    columns_ = all / cycles_per_column();
    cycle_of_column_ = static_cast<int>(all % cycles_per_column());
    fold_ = static_cast<int>(state >> kFoldBit);
  }
  // The number of cycles of the frame in which the matcher has still to work.
  std::uint64_t cycles_left() const {
    return (left_ + drain_left_) * static_cast<std::uint64_t>(geometry_.folds) -
           static_cast<std::uint64_t>(fold_);
  }
  // The number of cycles in which the matcher has worked, over all frames.
  std::uint64_t worked() const {
    return worked_before_frame_ +
           (geometry_.consume_cycles + geometry_.drain_cycles) * static_cast<std::uint64_t>(geometry_.folds) -
           cycles_left();
  }

 private:
  static constexpr unsigned kFoldBit = 11;
  static_assert(kernels::kMostRows < 1 << 6U);

  std::uint64_t cycles_per_column() const { return static_cast<std::uint64_t>(geometry_.cycles_per_column); }

  FrameGeometry geometry_;
  // From this column on, fewer rows of a strip lie inside the image. Never reached if all strips lie inside.
  std::uint64_t fewer_rows_column_ =
      geometry_.last_rows == geometry_.rows ? UINT64_MAX : geometry_.last_strip_column;
  std::uint64_t left_ = geometry_.consume_cycles;  // before the drain
  std::uint64_t drain_left_ = geometry_.drain_cycles;
  int fold_ = 0;               // cycles worked on the consume-cycle that is under way
  int cycle_of_column_ = 0;    // consume-cycles of the current column that have ended
  std::uint64_t columns_ = 0;  // columns consumed
  std::uint64_t worked_before_frame_ = 0;
};

}  // namespace stereotlm::fpga
