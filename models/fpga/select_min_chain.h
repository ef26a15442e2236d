#pragma once

#include <systemc>
#include <vector>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/kernels/column_scores.h"
#include "models/kernels/select_min.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Select-min unit A (paper section 3.3): the serial chain of comparators, for right-based matching; one for
// each of the R rows. With each column of window sums the match of the right pixel D-1 columns back leaves.
class SelectMinChain : public sc_core::sc_module {
 public:
  StreamOut<RightMatch> matches_out{"matches_out"};  // of the right pixel D-1 columns back

 private:
  void take(const WindowSums& window) {
    const auto row = static_cast<std::size_t>(window.row);
    matches_out->push({window.row, window.scores ? score_chains_[row].step(*window.scores, window.candidates)
                                                 : chains_[row].step(window.sums, window.candidates)});
  }

 public:
  // Of each column a beat for each of the R rows.
  StreamIn<WindowSums, SelectMinChain, &SelectMinChain::take> sums_in{"sums_in", this};

  // The configuration has no problems.
  SelectMinChain(const sc_core::sc_module_name& name, const CoreConfig& config) : sc_module(name) {
    const bool has_scores = kernels::ColumnScorer::is_needed(config.window, config.cost);
    for (int row = 0; row < config.rows; ++row) {
      if (has_scores) {
        score_chains_.emplace_back(config.disparities);
      } else {
        chains_.emplace_back(config.disparities);
      }
    }
  }

  void start_frame() {  // to be called before the first column of a frame
    for (auto& chain : chains_) chain.start_frame();
    for (auto& chain : score_chains_) chain.start_frame();
  }

 private:
  // [row]; one of them is empty.
  std::vector<kernels::SelectMinChain> chains_;
  std::vector<kernels::ScoreChain> score_chains_;  // if the beats have scores
};

}  // namespace stereotlm::fpga
