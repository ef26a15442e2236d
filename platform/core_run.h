#pragma once

#include <cstdint>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/statistics.h"

namespace stereotlm::platform {

// The timing of the board alone with an ideal host (`--source preloaded`), without pixels, modules and a
// kernel: the control of the core and the arbiters in a loop. The figures are those of PreloadedSystem at
// Fidelity::kTiming, for a tenth of the time. A process may do this as often as it likes.
//
// Throws std::invalid_argument if the board has problems, the tables do not fit to it, or there are no
// frames, and std::runtime_error if no slot of a frame is consumed and no result written for
// stall_timeout_cycles: it would never end.
Statistics run_core(const BoardConfig& board, const Tables& tables, std::uint64_t frames,
                    std::uint64_t stall_timeout_cycles = std::uint64_t{1} << 26U);

}  // namespace stereotlm::platform
