#include "sw/runs/simulation/preloaded_simulation.h"

namespace stereotlm::runs {

PreloadedSimulation::PreloadedSimulation(const platform::BoardConfig& board, const platform::Tables& tables,
                                         host::FrameSource& pairs, std::uint64_t frames, Binder& binder,
                                         fpga::Fidelity fidelity)
    : Simulation(board, tables, pairs, frames, fidelity),
      board_(board),
      tables_(tables),
      system_("system", board, tables, frames, *this, *this, binder, fidelity),
      counters_(platform::counters_of(system_.board)) {}

void PreloadedSimulation::end_early() {
  if (recorder() == nullptr) {
    set_frames(frames_done());
    return;
  }
  const std::uint64_t begun = recorder()->frames_begun();
  set_frames(begun);
  recorder()->record_only(begun);
}

platform::Statistics PreloadedSimulation::statistics() const {
  platform::Statistics statistics = platform::collect_statistics(board_, tables_, system_.board, counters_);
  check_conflicts(statistics);
  return statistics;
}

// Saves the counters at the end of each frame, because the counters of an interrupted run must not include a
// part of the running frame.
void PreloadedSimulation::take(std::uint64_t frame, const kernels::GrayImage& disparity) {
  counters_ = platform::counters_of(system_.board);
  add_result({frame, disparity});
}

}  // namespace stereotlm::runs
