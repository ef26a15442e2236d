#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "platform/board_config.h"
#include "sw/explore/allocation_search.h"
#include "sw/explore/sweep.h"

namespace stereotlm::explore {

// Simulates all that a search asks for, with the database `sweep.store`, and tells the search what comes out.
// `go_on` is called several times a second with the boards that are done and those that are left at most;
// false, and the search not at its end, if that has ended it. Throws as sweep() does, and std::runtime_error
// if a board could not be simulated.
bool simulate(AllocationSearch& search, const Evaluate& evaluate, const SweepOptions& sweep,
              const std::function<bool(std::uint64_t done, std::uint64_t most_left)>& go_on);

// "left_image bank0 bank1, .., right_lut bank0"
std::string allocation_text(const platform::BoardConfig& board);

}  // namespace stereotlm::explore
