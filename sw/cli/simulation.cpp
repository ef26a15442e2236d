#include "sw/cli/simulation.h"

#include <fmt/format.h>

#include <stdexcept>

namespace stereotlm::cli {
namespace {

constexpr double kSliceCycles = 40'000;

}  // namespace

Simulation::Simulation(const platform::BoardConfig& board, const platform::Tables& tables,
                       const host::StereoPair& pair, std::uint64_t frames)
    : board_(board),
      tables_(tables),
      pair_(pair),
      slice_(kSliceCycles / board.fpga.clock_mhz, sc_core::SC_US),
      system_("system", board, tables, frames, *this, *this, binder_),
      counters_(platform::counters_of(system_.board)) {}

void Simulation::advance() {
  sc_core::sc_start(slice_);
  if (!finished() && !sc_core::sc_pending_activity()) {
    throw std::runtime_error(
        fmt::format("the simulation has ended after {} frames: nothing is left that could finish the next",
                    frames_done()));
  }
}

platform::Statistics Simulation::statistics() const {
  return platform::collect_statistics(board_, tables_, system_.board, counters_);
}

const host::StereoPair& Simulation::pair(std::uint64_t /*frame*/) { return pair_; }

// Counters are taken at each frame's end, because those of a frame under way would be mixed into them when
// the run is interrupted.
void Simulation::take(std::uint64_t /*frame*/, const kernels::GrayImage& disparity) {
  counters_ = platform::counters_of(system_.board);
  disparity_ = disparity;
  cycles_of_done_ += system_.board.core.frame_cycles().back();
}

}  // namespace stereotlm::cli
