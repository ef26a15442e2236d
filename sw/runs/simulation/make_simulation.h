#pragma once

#include <cstdint>
#include <memory>

#include "models/binder.h"
#include "models/fpga/fidelity.h"
#include "models/host/frame_source.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "sw/runs/simulation/simulation.h"

namespace stereotlm::runs {

// The options of a simulation, without board, tables and pictures.
struct RunMode {
  bool camera = true;  // true: the whole computer; false: the board alone (preloaded)
  fpga::Fidelity fidelity = fpga::Fidelity::kFast;
  std::uint64_t frames = 1;
  bool record = false;  // see Simulation::take_conflicts(); the whole computer: also take_timeline()
};

// Creates a CameraSimulation or a PreloadedSimulation. The arguments, except `mode`, outlive it. Throws
// std::exception if it cannot be built.
std::unique_ptr<Simulation> make_simulation(const platform::BoardConfig& board,
                                            const platform::Tables& tables, host::FrameSource& pairs,
                                            const RunMode& mode, Binder& binder);

// Pairs of black pictures, for runs without pixels.
class BlankPairs : public host::FrameSource {
 public:
  explicit BlankPairs(const platform::BoardConfig& board) : image_(board.image) {}
  const host::StereoPair& pair(std::uint64_t /*frame*/) override {
    if (pair_.left.pixels.empty()) {
      pair_ = {{image_.width, image_.height}, {image_.width, image_.height}};
    }
    return pair_;
  }

 private:
  platform::ImageConfig image_;
  host::StereoPair pair_;  // created at its first use
};

}  // namespace stereotlm::runs
