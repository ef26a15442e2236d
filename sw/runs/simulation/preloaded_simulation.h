#pragma once

#include <cstdint>

#include "models/binder.h"
#include "models/host/frame_source.h"
#include "platform/collect.h"
#include "platform/preloaded_system.h"
#include "sw/runs/simulation/simulation.h"

namespace stereotlm::runs {

// `--source preloaded`: the board alone with an ideal host. Frame f shows pair f. A run that ends early drops
// the running frame, but finishes it if conflicts are recorded.
class PreloadedSimulation : public Simulation, private host::FrameSource, private host::FrameSink {
 public:
  // The referenced arguments outlive the simulation; `binder` binds its sockets. Throws std::exception if the
  // board cannot be built.
  PreloadedSimulation(const platform::BoardConfig& board, const platform::Tables& tables,
                      host::FrameSource& pairs, std::uint64_t frames, Binder& binder,
                      fpga::Fidelity fidelity = fpga::Fidelity::kCycle);

  void end_early() override;
  void record_rows() override { system_.board.core.frames().record_rows(); }
  std::vector<fpga::RowProfile> take_rows() override { return system_.board.core.frames().take_rows(); }
  platform::Statistics statistics() const override;

 private:
  const host::StereoPair& pair(std::uint64_t frame) override { return load_pair(frame); }
  void record(fpga::ConflictRecorder& conflicts) override { system_.board.core.frames().record(conflicts); }
  void record(fpga::CycleRecorder& cycles) override { system_.board.core.frames().record(cycles); }
  void take(std::uint64_t frame, const kernels::GrayImage& disparity) override;
  // Lets a frame that is fast-forwarded pass with the time, so that advance() returns within it.
  void check_progress() override { system_.board.core.catch_up(); }

  const platform::BoardConfig& board_;
  const platform::Tables& tables_;
  platform::PreloadedSystem system_;
  platform::BoardCounters counters_;  // counters at the end of the last finished frame
};

}  // namespace stereotlm::runs
