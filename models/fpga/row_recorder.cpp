#include "models/fpga/row_recorder.h"

namespace stereotlm::fpga {

void RowRecorder::start_frame(const CoreControl& control) {
  if (!is_on_) return;
  next_words_ = row_words_;
  rows_complete_ = 0;
  stalls_before_ = stalls_of(control);
}

void RowRecorder::note(std::uint64_t cycle, const CoreControl& control) {
  RowEnd& row = rows_[rows_complete_++];
  row = {cycle + 1, stalls_of(control)};
  for (std::size_t port = 0; port < kCorePortCount; ++port) row.stalls[port] -= stalls_before_[port];
  next_words_ = rows_complete_ == rows_.size() ? kNever : next_words_ + row_words_;
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
