#pragma once

#include <systemc>

#include "models/fpga/beats.h"
#include "models/kernels/select_min.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Select-min unit B (paper section 3.3): the tree of comparators, for left-based matching. With each column
// of window sums the match of its left pixel leaves.
class SelectMinTree : public sc_core::sc_module {
 public:
  StreamOut<LeftMatch> matches_out{"matches_out"};  // of the left pixel of each column

 private:
  void take(const WindowSums& window) {
    const std::uint8_t disparity =
        window.scores ? kernels::select_min_tree(*window.scores, window.candidates)
                      : kernels::select_min_tree(window.sums, window.candidates, window.lanes);
    matches_out->push({window.row, disparity, window.left_valid});
  }

 public:
  // Of each column a beat for each of the R rows.
  StreamIn<WindowSums, SelectMinTree, &SelectMinTree::take> sums_in{"sums_in", this};

  explicit SelectMinTree(const sc_core::sc_module_name& name) : sc_module(name) {}  // it has no state
};

}  // namespace stereotlm::fpga
