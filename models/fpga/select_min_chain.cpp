#include "models/fpga/select_min_chain.h"

#include "models/kernels/column_scores.h"

namespace stereotlm::fpga {

SelectMinChain::SelectMinChain(const sc_core::sc_module_name& name, const CoreConfig& config)
    : sc_module(name) {
  const bool has_scores = kernels::ColumnScorer::is_needed(config.window, config.cost);
  for (int row = 0; row < config.rows; ++row) {
    if (has_scores) {
      score_chains_.emplace_back(config.disparities);
    } else {
      chains_.emplace_back(config.disparities);
    }
  }
}

void SelectMinChain::start_frame() {
  for (auto& chain : chains_) chain.start_frame();
  for (auto& chain : score_chains_) chain.start_frame();
}

void SelectMinChain::take(const WindowSums& window) {
  const auto row = static_cast<std::size_t>(window.row);
  matches_out->push({window.row, window.scores ? score_chains_[row].step(*window.scores, window.candidates)
                                               : chains_[row].step(window.sums, window.candidates)});
}

}  // namespace stereotlm::fpga
