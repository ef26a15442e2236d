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
  explicit BlankPairs(const platform::BoardConfig& board) : image_(board.image) {}
  const host::StereoPair& pair(std::uint64_t /*frame*/) override {
    if (pair_.left.pixels.empty()) {
      const kernels::GrayImage black(image_.width, image_.height);
      pair_ = {black, black};
    }
    return pair_;
  }

 private:
  platform::ImageConfig image_;
  host::StereoPair pair_;  // empty until somebody looks
};

}  // namespace stereotlm::runs
