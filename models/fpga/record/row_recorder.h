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
  std::array<std::uint64_t, kCorePortCount> stalls{};

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

  void start_frame(const CoreControl& control);
  // The number of words written in the frame with which the next row is complete. While the recorder is off,
  // this number is never reached.
  std::uint64_t next_words() const { return next_words_; }
  // To be called after `cycle` if next_words() words have been written. `control` has been stepped in that
  // cycle.
  void note(std::uint64_t cycle, const CoreControl& control);

  // The complete rows of the frame that was started last, in `first_cycle`.
  RowProfile profile(std::uint64_t first_cycle) const;

 private:
  static constexpr std::uint64_t kNever = UINT64_MAX;
  using Stalls = std::array<std::uint64_t, kCorePortCount>;
  static Stalls stalls_of(const CoreControl& control);
  std::uint64_t words_up_to(std::size_t row) const;

  FrameGeometry geometry_;
  bool is_on_ = false;
  std::uint64_t next_words_ = kNever;
  Stalls stalls_before_{};  // [port]: stalls before the frame
  std::size_t rows_complete_ = 0;
  RowProfile rows_;  // `cycles` here counts from cycle 0 of the clock
};

}  // namespace stereotlm::fpga
