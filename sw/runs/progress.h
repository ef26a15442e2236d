#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

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

// For work in equal pieces: "12/48 boards simulated, 0:15 left". `before`: pieces that were done before
// `seconds` began. The time is left out until another one is done.
std::string progress_text(std::uint64_t done, std::uint64_t of, const std::string& pieces, double seconds,
                          std::uint64_t before = 0);

// Shows the progress of work, unless notes are left out: to the client of a worker, or on standard error. On
// a terminal it is one line, which the destructor erases; elsewhere a note every 10 s. Work that takes longer
// than 5 s is announced by a note as soon as that can be estimated.
class ProgressLine {
 public:
  // `work`: what is done: "9 frames are simulated". `stepped`: why cycle by cycle, see stepped_text().
  explicit ProgressLine(const std::string& work, const std::string& stepped = "",
                        std::chrono::milliseconds between_notes = std::chrono::seconds(10));
  ~ProgressLine() { erase(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // Shows the text that `line` returns for the seconds since construction, if it is time for that. `done` of
  // `of` pieces of work are done.
  void show(std::uint64_t done, std::uint64_t of, const std::function<std::string(double seconds)>& line);
  // Shows how long the work has taken. For work of which nothing else is known.
  void show_time();
  // Erases the line until the next show().
  void erase();

 private:
  using Time = std::chrono::steady_clock::time_point;

  std::string work_;  // empty once it was announced
  std::chrono::milliseconds between_notes_;
  Time start_;
  Time next_;
  Time next_note_;
  std::size_t columns_drawn_ = 0;
};

}  // namespace stereotlm::runs
