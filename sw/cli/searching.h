#pragma once

#include <optional>
#include <string>

#include "sw/explore/optimise/search.h"
#include "sw/explore/optimise/search_store.h"

namespace stereotlm::cli {

// "3.1e+09 boards: 1204 open, 312 simulated, best 26.04, bound 26.06, gap 0.08 %, 12 s". `has_gap`: whether
// the first goal is the question.
std::string progress_text(const explore::SearchState& state, bool has_gap, double seconds);

// Runs the search until it ends, is interrupted, or its time is over, and shows its progress. Returns whether
// it has ended. `store`: has the results of earlier runs, and keeps those of this one; null: none.
bool run_search(explore::Search& search, const explore::SearchStore* store, bool has_gap,
                std::optional<double> most_seconds = std::nullopt);

// What to say after an interrupt.
const char* resume_text(bool is_kept);

}  // namespace stereotlm::cli
