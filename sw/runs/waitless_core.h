#pragma once

#include <cstdint>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"

namespace stereotlm::runs {

// The frame rate of the core over frames 0..frames-1 if no port ever waited for a bank: each buffer is in a
// bank of its own, of the kind that it has now, and no host accesses the banks. Simulates one turn of the
// allocation's lists without pixels. Throws as platform::run_core() does.
double waitless_frames_per_second(const platform::BoardConfig& board, const platform::Tables& tables,
                                  std::uint64_t frames);

}  // namespace stereotlm::runs
