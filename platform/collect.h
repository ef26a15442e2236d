#pragma once

#include "platform/board.h"
#include "platform/board_config.h"
#include "platform/statistics.h"
#include "platform/tables.h"

namespace stereotlm::platform {

// The figures of all frames that the board has finished, with their bound, and the identities of contract
// section 6 checked: those that do not hold are listed in `failed`. To be called between two frames; the
// counters of a frame under way would be mixed in.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board);

}  // namespace stereotlm::platform
