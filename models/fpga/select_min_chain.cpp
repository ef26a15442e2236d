#include "models/fpga/select_min_chain.h"

#include "models/kernels/words.h"

namespace stereotlm::fpga {

SelectMinChain::SelectMinChain(const sc_core::sc_module_name& name, int disparities)
    : sc_module(name), chain_(disparities) {}

void SelectMinChain::take(const WindowSums& window) {
  const RightMatch match{chain_.step(window.sums, window.candidates)};
  ++stats_.columns;
  stats_.matches += std::uint64_t{match.disparity != kernels::kInvalidDisparity};
  matches_out->push(match);
}

}  // namespace stereotlm::fpga
