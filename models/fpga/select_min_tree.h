#pragma once

#include <cstdint>
#include <systemc>

#include "models/fpga/beats.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Select-min unit B (paper section 3.3): the tree of comparators, for left-based matching. With each column
// of window sums the match of its left pixel leaves.
class SelectMinTree : public sc_core::sc_module {
 public:
  struct Stats {
    std::uint64_t columns = 0;
    std::uint64_t matches = 0;  // left pixels that had a candidate
  };

  StreamOut<LeftMatch> matches_out{"matches_out"};

 private:
  void take(const WindowSums& window);

 public:
  StreamIn<WindowSums, SelectMinTree, &SelectMinTree::take> sums_in{"sums_in", this};

  explicit SelectMinTree(const sc_core::sc_module_name& name) : sc_module(name) {}

  const Stats& stats() const { return stats_; }

 private:
  Stats stats_;
};

}  // namespace stereotlm::fpga
