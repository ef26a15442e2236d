#pragma once

#include <cstdint>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/statistics.h"

namespace stereotlm::platform {

// Computes the figures of a board with an ideal host (`--source preloaded`) by a loop over the core's control
// and the arbiters, without pixels and without SystemC. The figures equal those of PreloadedSystem at
// Fidelity::kTiming, and take a tenth of the time. A process may call the function any number of times;
// sweeps do.
//
// Throws std::invalid_argument if the tables do not fit the board, or `frames` is 0.
// Throws std::runtime_error if the matcher does not work and no result is written for stall_timeout_cycles,
// because the frame would never end.
Statistics run_core(const BoardConfig& board, const Tables& tables, std::uint64_t frames,
                    std::uint64_t stall_timeout_cycles = std::uint64_t{1} << 26U);

}  // namespace stereotlm::platform
