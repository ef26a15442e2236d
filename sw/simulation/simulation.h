#pragma once

#include <cstdint>
#include <exception>
#include <systemc>
#include <vector>

#include "models/host/ideal_host.h"
#include "platform/collect.h"
#include "platform/preloaded_system.h"
#include "platform/statistics.h"

namespace stereotlm::cli {

// The board on the pairs of a source. One of these a process: SystemC elaborates once.
class Simulation : private host::FrameSource, private host::FrameSink {
 public:
  // All but `frames` outlives the simulation. Throws std::exception if the board cannot be built.
  Simulation(const platform::BoardConfig& board, const platform::Tables& tables, host::FrameSource& pairs,
             std::uint64_t frames);

  // Simulates about 40,000 FPGA cycles and returns the disparities of the frames that have ended in them, in
  // order. Throws sc_core::sc_report if a model reports an error, what `pairs` throws, and std::runtime_error
  // if nothing is left to happen before the last frame is finished.
  std::vector<kernels::GrayImage> advance();

  bool finished() const { return system_.host.finished(); }
  std::uint64_t frames_done() const { return counters_.frames; }
  std::uint64_t cycles_of_done() const { return cycles_of_done_; }     // of the finished frames
  std::uint64_t cycles() const { return system_.board.core.cycle(); }  // so far

  // Of the frames finished so far: their figures, which take their time, and the disparities of the last one.
  platform::Statistics statistics() const;
  const kernels::GrayImage& disparity() const { return disparity_; }

 private:
  const host::StereoPair& pair(std::uint64_t frame) override;
  void take(std::uint64_t frame, const kernels::GrayImage& disparity) override;

  const platform::BoardConfig& board_;
  const platform::Tables& tables_;
  host::FrameSource& pairs_;
  sc_core::sc_time slice_;
  std::vector<kernels::GrayImage> ended_;  // since the last advance() began
  kernels::GrayImage disparity_;
  std::exception_ptr failure_;  // of the source
  std::uint64_t cycles_of_done_ = 0;
  Binder binder_;
  platform::PreloadedSystem system_;
  platform::BoardCounters counters_;  // at the end of the last finished frame
};

}  // namespace stereotlm::cli
