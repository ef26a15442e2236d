#pragma once

#include <cstdint>
#include <memory>

#include "models/binder.h"
#include "models/fpga/stereo_core.h"
#include "models/host/ideal_host.h"
#include "platform/board_config.h"
#include "platform/tables.h"
#include "sw/simulation/simulation.h"

namespace stereotlm::simulation {

// What a run is told beside its board, tables and pictures.
struct RunMode {
  bool camera = true;  // the whole computer, else the board alone (preloaded)
  fpga::Fidelity fidelity = fpga::Fidelity::kFast;
  std::uint64_t frames = 1;
};

// All but `mode` outlives the simulation. Throws std::exception if it cannot be built.
std::unique_ptr<Simulation> make_simulation(const platform::BoardConfig& board,
                                            const platform::Tables& tables, host::FrameSource& pairs,
                                            const RunMode& mode, Binder& binder);

// Pairs of black pictures, where no pixel matters.
class BlankPairs : public host::FrameSource {
 public:
  explicit BlankPairs(const platform::BoardConfig& board)
      : pair_{kernels::GrayImage(board.image.width, board.image.height),
              kernels::GrayImage(board.image.width, board.image.height)} {}
  const host::StereoPair& pair(std::uint64_t /*frame*/) override { return pair_; }

 private:
  host::StereoPair pair_;
};

}  // namespace stereotlm::simulation
