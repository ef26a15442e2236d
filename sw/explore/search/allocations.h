#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::explore {

// Where each buffer of a board lies, in the order of platform::buffers(): an index into BoardConfig::banks.
using Placement = std::vector<int>;

// Different banks that a placement uses.
int banks_used(const Placement& placement);

// Whether each bank holds its buffers.
bool fits(const platform::BoardConfig& board, const Placement& placement);

// Every placement of the board's buffers in at most `most_banks` of its banks, each once: of placements that
// differ only by an exchange of banks that are alike (depth, kind, turnaround), the one that takes them in
// the board's order. In the order of the first buffer's bank, then the second's, ..; those that do not fit
// too.
void for_each_placement(const platform::BoardConfig& board, int most_banks,
                        const std::function<void(const Placement&)>& visit);

// The board with its buffers placed so.
platform::BoardConfig placed(const platform::BoardConfig& board, const Placement& placement);

// Whether a frame of the core alone leaves nothing behind that the next one could observe: an arbitration
// policy that forgets, and no bank with turnaround. (The search places of round robin persist, and the
// direction of the last access to a bank with turnaround.)
bool frames_are_independent(const platform::BoardConfig& board);

// The board that does one frame of the list's cycle, with the buffers of that frame alone, in the first banks
// that are like those of the placement. Frames of different placements for which it is the same take the same
// cycles, if frames_are_independent().
platform::BoardConfig board_of_frame(const platform::BoardConfig& board, const Placement& placement,
                                     std::uint64_t frame);

// "left_image bank0 bank1, .., right_lut bank0"
std::string allocation_text(const platform::BoardConfig& board);

}  // namespace stereotlm::explore
