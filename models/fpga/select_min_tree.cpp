#include "models/fpga/select_min_tree.h"

#include "models/kernels/select_min.h"
#include "models/kernels/words.h"

namespace stereotlm::fpga {

void SelectMinTree::take(const WindowSums& window) {
  const std::uint8_t disparity = window.scores
                                     ? kernels::select_min_tree(*window.scores, window.candidates)
                                     : kernels::select_min_tree(window.sums, window.candidates, window.lanes);
  const LeftMatch match{window.row, disparity, window.left_valid};
  ++stats_.columns;
  stats_.matches += std::uint64_t{match.disparity != kernels::kInvalidDisparity};
  matches_out->push(match);
}

}  // namespace stereotlm::fpga
