#include "models/fpga/record/row_recorder.h"

namespace stereotlm::fpga {

void RowRecorder::start_frame(const CoreControl& control) {
  if (!is_on_) return;
  next_words_ = words_up_to(0);
  rows_complete_ = 0;
  stalls_before_ = stalls_of(control);
}

void RowRecorder::note(std::uint64_t cycle, const CoreControl& control) {
  RowEnd& row = rows_[rows_complete_++];
  row = {cycle + 1, stalls_of(control)};
  for (std::size_t port = 0; port < kCorePortCount; ++port) row.stalls[port] -= stalls_before_[port];
  next_words_ = rows_complete_ == rows_.size() ? kNever : words_up_to(rows_complete_);
}

// The number of words of a frame up to the last one of a row, this one included. The words of a strip leave
// in groups, which have a word for each row of the strip that lies inside the image.
std::uint64_t RowRecorder::words_up_to(std::size_t row) const {
  const auto rows = static_cast<std::size_t>(geometry_.rows);
  const std::size_t strip_row = row / rows * rows;
  const std::uint64_t row_words = geometry_.columns_per_strip() / 4;
  const bool is_last_strip = strip_row + rows >= rows_.size();
  const auto rows_inside = static_cast<std::size_t>(is_last_strip ? geometry_.last_rows : geometry_.rows);
  return strip_row * row_words + (row_words - 1) * rows_inside + (row - strip_row) + 1;
}

RowProfile RowRecorder::profile(std::uint64_t first_cycle) const {
  RowProfile profile(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(rows_complete_));
  for (RowEnd& row : profile) row.cycles -= first_cycle;
  return profile;
}

RowRecorder::Stalls RowRecorder::stalls_of(const CoreControl& control) {
  Stalls stalls{};
  for (std::size_t port = 0; port < kCorePortCount; ++port)
    stalls[port] = control.port_cycles(port).stalled();
  return stalls;
}

}  // namespace stereotlm::fpga
