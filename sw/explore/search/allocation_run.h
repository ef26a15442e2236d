#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "platform/config/board_config.h"
#include "sw/explore/search/allocation_search.h"
#include "sw/explore/sweep/sweep.h"

namespace stereotlm::explore {

// Simulates all that a search asks for, with the database `sweep.store`, and tells the search what comes out.
// `keep_going` is called several times a second with the boards that are done and those that are left at
// most; false, and the search not at its end, if that has ended it. A board that could not be simulated is
// recorded as one that has failed. Throws as sweep() does.
bool simulate(AllocationSearch& search, const Evaluate& evaluate, const SweepOptions& sweep,
              const std::function<bool(std::uint64_t done, std::uint64_t most_left)>& keep_going);

}  // namespace stereotlm::explore
