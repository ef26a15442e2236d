#include "sw/runs/simulation/make_simulation.h"

#include "sw/runs/simulation/camera_simulation.h"
#include "sw/runs/simulation/preloaded_simulation.h"

namespace stereotlm::runs {

std::unique_ptr<Simulation> make_simulation(const platform::BoardConfig& board,
                                            const platform::Tables& tables, host::FrameSource& pairs,
                                            const RunMode& mode, Binder& binder) {
  if (mode.camera) {
    auto simulation =
        std::make_unique<CameraSimulation>(board, tables, pairs, mode.frames, binder, mode.fidelity);
    if (mode.record) simulation->record_timeline();
    if (mode.record) simulation->record_conflicts();
    return simulation;
  }
  auto simulation =
      std::make_unique<PreloadedSimulation>(board, tables, pairs, mode.frames, binder, mode.fidelity);
  if (mode.record) simulation->record_conflicts();
  return simulation;
}

}  // namespace stereotlm::runs
