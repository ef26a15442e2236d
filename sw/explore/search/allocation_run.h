#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "platform/config/board_config.h"
#include "sw/explore/search/allocation_search.h"
#include "sw/explore/sweep/sweep.h"

namespace stereotlm::explore {

// The progress of simulate().
struct SearchProgress {
  std::uint64_t done = 0;       // boards with a result
  std::uint64_t simulated = 0;  // those of `done` that the store did not have before
  std::uint64_t most_left = 0;  // upper limit for the boards that are left
  // Whether most_left is without the boards that first results leave out. The first results leave out most
  // boards.
  bool is_narrowed = false;
};

// Simulates the boards that a search selects, until it selects no more, and records the results in the
// search. The results are stored in `sweep.store`. `keep_going` is called several times a second. The search
// ends early if it returns false, and simulate() then returns false; results until then are recorded. A board
// that could not be simulated is recorded as failed. Throws as sweep() does.
bool simulate(AllocationSearch& search, const Evaluate& evaluate, const SweepOptions& sweep,
              const std::function<bool(const SearchProgress& progress)>& keep_going);

}  // namespace stereotlm::explore
