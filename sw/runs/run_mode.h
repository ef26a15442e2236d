#pragma once

#include "sw/runs/run_input.h"
#include "sw/runs/simulation/make_simulation.h"

namespace stereotlm::runs {

// The mode of the simulation that the options of a run request.
inline RunMode run_mode(const RunInput& input) {
  const fpga::Fidelity fast = input.timing_only ? fpga::Fidelity::kTiming : fpga::Fidelity::kFast;
  return {input.camera, input.fast ? fast : fpga::Fidelity::kCycle, input.frames,
          input.record || input.trace != nullptr};
}

}  // namespace stereotlm::runs
