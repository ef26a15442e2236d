#include "sw/cli/simulation.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace stereotlm::cli {
namespace {

constexpr double kSliceCycles = 40'000;

}  // namespace

Simulation::Simulation(const platform::BoardConfig& board, const platform::Tables& tables,
                       host::FrameSource& pairs, std::uint64_t frames)
    : board_(board),
      tables_(tables),
      pairs_(pairs),
      slice_(kSliceCycles / board.fpga.clock_mhz, sc_core::SC_US),
      system_("system", board, tables, frames, *this, *this, binder_),
      counters_(platform::counters_of(system_.board)) {}

std::vector<kernels::GrayImage> Simulation::advance() {
  ended_.clear();
  try {
    sc_core::sc_start(slice_);
  } catch (const sc_core::sc_report&) {
    if (failure_) std::rethrow_exception(failure_);  // SystemC has put a report in its place
    throw;
  }
  if (!finished() && !sc_core::sc_pending_activity()) {
    throw std::runtime_error(
        fmt::format("the simulation has ended after {} frames: nothing is left that could finish the next",
                    frames_done()));
  }
  return std::move(ended_);
}

platform::Statistics Simulation::statistics() const {
  return platform::collect_statistics(board_, tables_, system_.board, counters_);
}

const host::StereoPair& Simulation::pair(std::uint64_t frame) {
  try {
    return pairs_.pair(frame);
  } catch (...) {
    failure_ = std::current_exception();
    throw;
  }
}

// Counters are taken at each frame's end, because those of a frame under way would be mixed into them when
// the run is interrupted.
void Simulation::take(std::uint64_t /*frame*/, const kernels::GrayImage& disparity) {
  counters_ = platform::counters_of(system_.board);
  disparity_ = disparity;
  ended_.push_back(disparity);
  cycles_of_done_ += system_.board.core.frame_cycles().back();
}

}  // namespace stereotlm::cli
