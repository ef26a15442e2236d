#pragma once

#include <cstdint>
#include <exception>
#include <vector>

#include "models/fpga/fidelity.h"
#include "models/fpga/row_profile.h"
#include "models/host/frame_source.h"
#include "models/kernels/gray_image.h"
#include "platform/config/board_config.h"
#include "platform/statistics.h"

namespace stereotlm::fpga {
class StereoCore;
}

namespace stereotlm::runs {

struct Result {
  std::uint64_t number = 0;  // number of the camera frame; it shows pair `number` modulo the number of pairs
  kernels::GrayImage disparity;
  std::uint64_t time_ps = 0;  // time of its delivery
};

// Simulates a board and its surroundings on the pairs of a source until `frames` results are delivered. One
// object per process: SystemC elaborates once.
class Simulation {
 public:
  virtual ~Simulation() = default;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // Simulates for some ms of wall time (at fast, as long as the pixels of a frame take) and returns the new
  // results in order. Throws sc_core::sc_report if a model reports an error, what the source throws, and
  // std::runtime_error if no event is left or nothing proceeds before the last frame is finished.
  std::vector<Result> advance();

  // Ends the run as soon as its results equal those of a complete run with fewer frames: the finished frames,
  // and running frames that have already changed the counters.
  virtual void end_early() = 0;

  std::uint64_t frames() const { return frames_; }  // frames of the whole run
  std::uint64_t frames_done() const { return frames_done_; }
  bool finished() const { return frames_done_ == frames_; }
  // FPGA cycles from time 0 until now, and until the last result.
  std::uint64_t cycles() const;
  std::uint64_t cycles_of_done() const { return cycles_of_done_; }

  // Records, from the next frame of the core on, when each row of results is complete.
  void record_rows();
  // The rows of frames that the core has finished since the last call, in the order of the results. In a
  // computer the results are delivered later.
  std::vector<fpga::RowProfile> take_rows();

  // The figures of the finished frames. No frame may be running that end_early() would finish; a computer needs
  // at least one finished frame.
  virtual platform::Statistics statistics() const = 0;
  const Result& last() const { return last_; }

 protected:
  // `board` and `pairs` outlive the simulation.
  Simulation(const platform::BoardConfig& board, host::FrameSource& pairs, std::uint64_t frames,
             fpga::Fidelity fidelity);

  void set_frames(std::uint64_t frames) { frames_ = frames; }
  // Called within a SystemC process; an exception of the source ends that process.
  const host::StereoPair& load_pair(std::uint64_t number);
  void add_result(Result result);
  virtual fpga::StereoCore& core() = 0;
  // Throws std::runtime_error if nothing has proceeded for too long.
  virtual void check_progress() {}

 private:
  const platform::BoardConfig& board_;
  host::FrameSource& pairs_;
  double slice_cycles_;
  std::uint64_t frames_;
  std::uint64_t frames_done_ = 0;
  std::uint64_t cycles_of_done_ = 0;
  std::vector<Result> new_;  // results since the last advance() began
  Result last_;
  std::exception_ptr failure_;  // exception of the source
};

}  // namespace stereotlm::runs
