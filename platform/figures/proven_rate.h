#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/figures/bounds.h"
#include "platform/figures/statistics.h"

namespace stereotlm::platform {

// What contract 7.12 proves of the rate of a computer in the long run, while its captures lose no pixels.
// `frame_cycles`: lengths of the first frames of a run. nullopt if they are less than a turn of the lists.
// `bound`: bound.system. It takes some 20 us.
std::optional<ProvenRate> proven_rate(const BoardConfig& board, const FrameAccesses& accesses,
                                      const std::vector<std::uint64_t>& frame_cycles, double bound);

// Whether the core and the host never meet in a bank, in any run of the computer: each frame takes the cycles
// of the core alone, and no word of the host waits for the core (contract 7.12: all a and X are 0).
bool frames_are_apart(const BoardConfig& board, const FrameAccesses& accesses);

}  // namespace stereotlm::platform
