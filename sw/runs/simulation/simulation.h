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
  std::uint64_t number = 0;  // of the camera frame, which shows pair `number` modulo the number of pairs
  kernels::GrayImage disparity;
  std::uint64_t time_ps = 0;  // when it was there, from time 0
};

// A board and what is around it, on the pairs of a source, until `frames` results are there. One of these a
// process: SystemC elaborates once.
class Simulation {
 public:
  virtual ~Simulation() = default;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // Simulates for a while, some ms of wall time and at fast as long as the pixels of a frame take, and
  // returns the results that have come in them, in order. Throws sc_core::sc_report if a model reports an
  // error, what the source throws, and std::runtime_error if nothing is left to happen, or nothing goes on,
  // before the last frame is finished.
  std::vector<Result> advance();

  // To be finished as soon as the results are those of a whole run of fewer frames: of those that are done,
  // and of those under way where they have left their traces.
  virtual void end_early() = 0;

  std::uint64_t frames() const { return frames_; }  // to do
  std::uint64_t frames_done() const { return frames_done_; }
  bool finished() const { return frames_done_ == frames_; }
  // FPGA cycles since time 0, and those by the last result.
  std::uint64_t cycles() const;
  std::uint64_t cycles_of_done() const { return cycles_of_done_; }

  // From the next frame of the core on: when its rows of results were whole.
  void record_rows();
  // Of the frames that the core has finished since the last call. Results come in the same order, of a
  // computer later.
  std::vector<fpga::RowProfile> take_rows();

  // Of the frames that are done, with no other under way that end_early() would finish; one at least for a
  // computer.
  virtual platform::Statistics statistics() const = 0;
  const Result& last() const { return last_; }

 protected:
  // `board` and `pairs` outlive the simulation.
  Simulation(const platform::BoardConfig& board, host::FrameSource& pairs, std::uint64_t frames,
             fpga::Fidelity fidelity);

  void set_frames(std::uint64_t frames) { frames_ = frames; }
  // Within a SystemC process, which an exception of the source ends.
  const host::StereoPair& load_pair(std::uint64_t number);
  void add_result(Result result);
  virtual fpga::StereoCore& core() = 0;
  // Throws std::runtime_error if nothing has gone on for too long.
  virtual void check_progress() {}

 private:
  const platform::BoardConfig& board_;
  host::FrameSource& pairs_;
  double slice_cycles_;
  std::uint64_t frames_;
  std::uint64_t frames_done_ = 0;
  std::uint64_t cycles_of_done_ = 0;
  std::vector<Result> new_;  // since the last advance() began
  Result last_;
  std::exception_ptr failure_;  // of the source
};

}  // namespace stereotlm::runs
