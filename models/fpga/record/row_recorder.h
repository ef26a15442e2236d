#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/fpga/core_control.h"
#include "models/fpga/core_ports.h"

namespace stereotlm::fpga {

// The end of a row of results, which is the write of its last word.
struct RowEnd {
  std::uint64_t cycles = 0;  // cycles of the frame up to that write, its own cycle included
  // [port]: in how many of these cycles the port was stalled. The host has no entry, because its words are
  // not counted cycle by cycle where they are uncontended.
  std::vector<std::uint64_t> stalls;

  friend bool operator==(const RowEnd& a, const RowEnd& b) {
    return a.cycles == b.cycles && a.stalls == b.stalls;
  }
  friend bool operator!=(const RowEnd& a, const RowEnd& b) { return !(a == b); }
};

// The ends of the rows of a frame, top row first. The cycles of the last row are the counted cycles of the
// frame.
using RowProfile = std::vector<RowEnd>;

// Records when the rows of results of a frame are complete, once it is turned on. Its only cost is that the
// stepper compares the words written with next_words() after each cycle.
class RowRecorder {
 public:
  explicit RowRecorder(const FrameGeometry& geometry)
      : geometry_(geometry), rows_(static_cast<std::size_t>(geometry.height)) {}

  void turn_on() { is_on_ = true; }  // from the next frame on
  bool is_on() const { return is_on_; }

  void start_frame(const CoreControl& control) {
    if (!is_on_) return;
    next_words_ = words_up_to(0);
    rows_complete_ = 0;
    before_ = stalls_of(control);
  }
  // The number of words written in the frame with which the next row is complete. While the recorder is off,
  // this number is never reached.
  std::uint64_t next_words() const { return next_words_; }
  // To be called after `cycle` if next_words() words have been written. `control` has been stepped in that
  // cycle.
  void note(std::uint64_t cycle, const CoreControl& control) {
    rows_[rows_complete_++] = {cycle + 1, stalls_of(control)};
    next_words_ = rows_complete_ == rows_.size() ? kNever : words_up_to(rows_complete_);
  }

  // The complete rows of the frame that was started last, in `first_cycle`.
  RowProfile profile(std::uint64_t first_cycle) const {
    RowProfile profile(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(rows_complete_));
    for (RowEnd& row : profile) {
      row.cycles -= first_cycle;
      for (std::size_t port = 0; port < before_.size(); ++port) row.stalls[port] -= before_[port];
    }
    return profile;
  }

 private:
  static constexpr std::uint64_t kNever = UINT64_MAX;
  using Stalls = std::vector<std::uint64_t>;

  static Stalls stalls_of(const CoreControl& control) {
    Stalls stalls(control.ports().core_size());
    for (std::size_t port = 0; port < stalls.size(); ++port)
      stalls[port] = control.port_cycles(port).stalled();
    return stalls;
  }
  // The number of words of a frame up to the last one of a row, this one included. The words of a strip leave
  // in groups, which have a word for each row of the strip that lies inside the image.
  std::uint64_t words_up_to(std::size_t row) const {
    const auto rows = static_cast<std::size_t>(geometry_.rows);
    const std::size_t strip_row = row / rows * rows;
    const std::uint64_t row_words = geometry_.columns_per_strip() / 4;
    const bool is_last_strip = strip_row + rows >= rows_.size();
    const auto rows_inside = static_cast<std::size_t>(is_last_strip ? geometry_.last_rows : geometry_.rows);
    return strip_row * row_words + (row_words - 1) * rows_inside + (row - strip_row) + 1;
  }

  FrameGeometry geometry_;
  bool is_on_ = false;
  std::uint64_t next_words_ = kNever;
  Stalls before_;  // [port]: stalls before the frame
  std::size_t rows_complete_ = 0;
  RowProfile rows_;  // counted from cycle 0 of the clock
};

}  // namespace stereotlm::fpga
