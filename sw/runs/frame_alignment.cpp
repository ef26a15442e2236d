#include "sw/runs/frame_alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "sw/process/interrupt.h"

namespace stereotlm::runs {
namespace {

constexpr std::chrono::milliseconds kBetweenPolls{100};

}  // namespace

DiffLimits::DiffLimits(const RecordedRun& a, const RecordedRun& b) {
  const platform::ImageConfig& size_a = a.board.image;
  const platform::ImageConfig& size_b = b.board.image;
  if (size_a.width != size_b.width || size_a.height != size_b.height) {
    rows = pixels = fmt::format("images of {}x{} in A, of {}x{} in B", size_a.width, size_a.height,
                                size_b.width, size_b.height);
  } else if (a.options.timing_only || b.options.timing_only) {
    const bool both = a.options.timing_only && b.options.timing_only;
    pixels = fmt::format("there are none in {}", both ? "both" : a.options.timing_only ? "A" : "B");
  }
}

FrameAlignment::FrameAlignment(const RecordedRun& a, const RecordedRun& b, const DiffLimits& limits,
                               stats::RowsCsv* csv, Rerun::Record record_a, Rerun::Record record_b)
    : limits_(limits),
      csv_(csv),
      frames_(std::max(a.options.frames, b.options.frames)),
      a_(a, std::move(record_a)),
      b_(b, std::move(record_b)) {}

bool FrameAlignment::run() {
  bool goes_on = read(a_) && read(b_);
  // Advances the run with the lower camera frame, or both runs if these are equal, so that neither run passes
  // a frame that the other one still needs.
  while (goes_on && (a_.ahead || b_.ahead)) {
    const bool takes_a = a_.ahead && (!b_.ahead || a_.ahead->number <= b_.ahead->number);
    const bool takes_b = b_.ahead && (!a_.ahead || b_.ahead->number <= a_.ahead->number);
    if (takes_a && takes_b && limits_.pixels.empty()) {
      pixels_.add(a_.ahead->number, a_.ahead->disparity, b_.ahead->disparity);
      last_common_ = {a_.ahead->number, std::move(a_.ahead->disparity), std::move(b_.ahead->disparity)};
    }
    goes_on = (!takes_a || advance(a_, b_)) && (!takes_b || advance(b_, a_));
    compare_rows();
  }
  progress_.erase();
  return goes_on;
}

// Reads the next frame of a run. Polls for interrupts while it waits, and returns false after one.
bool FrameAlignment::read(Side& side) {
  do {
    if (process::interrupted()) return false;
    progress_.show([this](double) { return fmt::format("{}/{} frames compared", rows_.frames(), frames_); });
  } while (!side.rerun.has_news(kBetweenPolls));
  side.ahead = side.rerun.next();
  return true;
}

bool FrameAlignment::advance(Side& side, const Side& other) {
  const bool has_partner = other.ahead || !other.rows.empty();
  if (limits_.rows.empty() && has_partner) side.rows.push_back(std::move(side.ahead->rows));
  return read(side);
}

void FrameAlignment::compare_rows() {
  while (!a_.rows.empty() && !b_.rows.empty()) {
    rows_.add(a_.rows.front(), b_.rows.front());
    if (csv_ != nullptr) csv_->add(a_.rows.front(), b_.rows.front());
    a_.rows.pop_front();
    b_.rows.pop_front();
  }
}

}  // namespace stereotlm::runs
