#pragma once

#include "sw/cli/run_input.h"
#include "sw/simulation/make_simulation.h"

namespace stereotlm::cli {

// How the simulation of a run works.
inline simulation::RunMode run_mode(const RunInput& input) {
  const fpga::Fidelity fast = input.timing_only ? fpga::Fidelity::kTiming : fpga::Fidelity::kFast;
  return {input.camera, input.fast ? fast : fpga::Fidelity::kCycle, input.frames};
}

}  // namespace stereotlm::cli
