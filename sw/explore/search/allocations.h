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
// differ only by an exchange of equal banks (same depth, kind and turnaround), it visits only the one that
// uses the equal banks in the board's order. Placements come in the order of the first buffer's bank, then of
// the second buffer's bank, and so on. Placements that do not fit are visited too.
void for_each_placement(const platform::BoardConfig& board, int most_banks,
                        const std::function<void(const Placement&)>& visit);

// The board with its buffers in the banks of the placement.
platform::BoardConfig placed(const platform::BoardConfig& board, const Placement& placement);

// Whether a frame of the core alone leaves no state behind that the next frame could observe. That holds if
// the arbitration policy forgets, and no bank has turnaround. (Round robin keeps the place of its search; a
// bank with turnaround keeps the direction of its last access.)
bool frames_are_independent(const platform::BoardConfig& board);

// A board that computes only frame number `frame` of the placement: it has only the buffers of that frame.
// Its name is "one frame of NAME", for those who read it in a database. Each bank of the placement is
// replaced by the first equal bank that has not yet replaced another one. If frames_are_independent(), two
// frames with the same such board take the same number of cycles, even if they belong to different
// placements.
platform::BoardConfig board_of_frame(const platform::BoardConfig& board, const Placement& placement,
                                     std::uint64_t frame);

// "left_image bank0 bank1, .., right_lut bank0"
std::string allocation_text(const platform::BoardConfig& board);

}  // namespace stereotlm::explore
