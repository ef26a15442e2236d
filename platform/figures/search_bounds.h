#pragma once

#include <cstdint>

#include "platform/config/board_config.h"
#include "platform/figures/bounds.h"

// Lower bounds for a search that rules out placements without a simulation. They also count what the ports
// that share a bank cost one another. Each is proved in sw/explore/BOUNDS.md. They are tighter than those of
// bounds.h, which are printed and which the contract fixes.
namespace stereotlm::platform {

// Frame number `frame` of the core alone takes at least so many cycles, whatever ran before it. Never less
// than the largest of frame_bounds(). `accesses`: frame_accesses(), or identity_accesses().
std::uint64_t least_frame_cycles(const BoardConfig& board, const FrameAccesses& accesses,
                                 std::uint64_t frame);

}  // namespace stereotlm::platform
