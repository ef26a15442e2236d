#include "models/fpga/select_min_tree.h"

#include "models/kernels/select_min.h"
#include "models/kernels/words.h"

namespace stereotlm::fpga {

void SelectMinTree::take(const WindowSums& window) {
  const LeftMatch match{kernels::select_min_tree(window.sums, window.candidates, window.lanes),
                        window.left_valid};
  ++stats_.columns;
  stats_.matches += std::uint64_t{match.disparity != kernels::kInvalidDisparity};
  matches_out->push(match);
}

}  // namespace stereotlm::fpga
