#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "platform/config/board_config.h"
#include "sw/explore/search/allocation_search.h"
#include "sw/explore/sweep/sweep.h"

namespace stereotlm::explore {

// Simulates the boards that a search selects, until it selects no more, and records the results in the
// search. The results are stored in `sweep.store`. `keep_going` is called several times a second with the
// number of boards that are done, and an upper limit for those that are left. The search ends early if
// `keep_going` returns false, and simulate() then returns false. A board that could not be simulated is
// recorded as failed. Throws as sweep() does.
bool simulate(AllocationSearch& search, const Evaluate& evaluate, const SweepOptions& sweep,
              const std::function<bool(std::uint64_t done, std::uint64_t most_left)>& keep_going);

}  // namespace stereotlm::explore
