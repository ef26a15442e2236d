#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "sw/explore/search/allocation_search.h"
#include "sw/explore/sweep/sweep.h"

namespace stereotlm::runs {

// The figures from which the progress of a run is computed. A running frame counts in proportion to its
// simulated cycles.
struct RunState {
  std::uint64_t frames = 0;  // frames of the whole run
  std::uint64_t frames_done = 0;
  std::uint64_t cycles_of_done = 0;      // FPGA cycles until the end of the last finished frame
  std::uint64_t cycles = 0;              // FPGA cycles simulated
  std::uint64_t least_frame_cycles = 1;  // assumed length of a frame until one has finished
};

// For a run: "1.25/4 frames   31.2 %   8.40 M cycles/s   3.91 frames/s   0:08 left"
std::string progress_text(const RunState& state, double seconds);

// For a sweep: "3/10 points   30.0 %   2.0 points/s   0:04 left". `before`: points that were done before
// `seconds` began.
std::string progress_text(const explore::SweepCounts& counts, std::uint64_t before, double seconds);

// For a search: "332 boards simulated, 120 left at most (0:05 at this rate)". The time is left out until
// most_left is narrowed and 8 boards were simulated.
std::string progress_text(const explore::SearchProgress& progress, double seconds);

// A progress line on standard error, if that is a terminal and notes are shown, or for the client of a
// worker. The destructor erases it.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine() { erase(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // Redraws the text that `line` returns for the seconds since construction, at most a few times a second.
  // `done` of `of` pieces of work are done.
  void show(std::uint64_t done, std::uint64_t of, const std::function<std::string(double seconds)>& line);
  // Erases the line until the next show().
  void erase();

 private:
  using Time = std::chrono::steady_clock::time_point;

  bool is_shown_;
  Time start_;
  Time next_;
  std::size_t columns_drawn_ = 0;
};

}  // namespace stereotlm::runs
