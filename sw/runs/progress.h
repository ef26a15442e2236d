#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace stereotlm::runs {

// How far a run is. A frame in progress counts by its simulated cycles.
struct RunState {
  std::uint64_t frames = 0;  // to do, all in all
  std::uint64_t frames_done = 0;
  std::uint64_t cycles_of_done = 0;      // FPGA cycles by the end of the last of them
  std::uint64_t cycles = 0;              // FPGA cycles simulated
  std::uint64_t least_frame_cycles = 1;  // stands for the length of a frame until one has finished
};

// "1.25/4 frames   31.2 %   8.40 M cycles/s   3.91 frames/s   0:08 left"
std::string progress_text(const RunState& state, double seconds);

// "0:08", "1:02:03", "years"
std::string time_text(double seconds);

// "verifying: 1/5 frames": how far the comparison with the other run is.
std::string verification_text(std::uint64_t frames_compared, std::uint64_t frames);

// A progress line, on standard error if that is a terminal; otherwise nothing. The line is erased at the end.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine() { erase(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // Draws the line anew, at most a few times a second.
  void show(const RunState& state);
  // `line` is given the seconds since this was made.
  void show(const std::function<std::string(double seconds)>& line);
  // Takes it away, until it is shown again.
  void erase();

 private:
  using Time = std::chrono::steady_clock::time_point;

  bool is_terminal_;
  Time start_;
  Time next_;
  std::size_t columns_drawn_ = 0;
};

}  // namespace stereotlm::runs
