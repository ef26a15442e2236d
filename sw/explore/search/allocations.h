#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::explore {

// The bank of each buffer of a board, as an index into BoardConfig::banks, in the order of
// platform::buffers().
using Placement = std::vector<int>;

// The number of different banks that a placement uses.
int banks_used(const Placement& placement);

// Whether each bank is deep enough for its buffers.
bool fits(const platform::BoardConfig& board, const Placement& placement);

// Visits every placement of the board's buffers in at most `most_banks` of its banks. Among placements that
// differ only by an exchange of equal banks (depth, kind, turnaround) it visits only the one that uses those
// in the board's order. The order is that of the first buffer's bank, then of the second's, and so on.
// Placements that do not fit are visited too.
void for_each_placement(const platform::BoardConfig& board, int most_banks,
                        const std::function<void(const Placement&)>& visit);

// The board with its buffers in the banks of the placement.
platform::BoardConfig placed(const platform::BoardConfig& board, const Placement& placement);

// Whether a frame of the core alone leaves no state behind that the next frame could observe: fixed priority,
// and no bank with turnaround. (The search places of round robin persist, and the direction of the last
// access to a bank with turnaround.)
bool frames_are_independent(const platform::BoardConfig& board);

// A board that computes one frame of the lists' turn, with the buffers of that frame alone. Each lies in the
// first unused bank that equals its bank in the placement. If frames_are_independent(), frames of different
// placements that have the same such board take the same number of cycles.
platform::BoardConfig board_of_frame(const platform::BoardConfig& board, const Placement& placement,
                                     std::uint64_t frame);

// "left_image bank0 bank1, .., right_lut bank0"
std::string allocation_text(const platform::BoardConfig& board);

}  // namespace stereotlm::explore
