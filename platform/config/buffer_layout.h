#pragma once

#include <vector>

#include "models/fpga/frame_buffers.h"
#include "models/words_by_range.h"
#include "platform/config/board_config.h"

namespace stereotlm::platform {

// Throws as layout_buffers() does.
fpga::FrameBuffers frame_buffers(const BoardConfig& board);

// The addresses of the buffers on the local bus, in the order of buffers() in board_rules.h. Throws as
// layout_buffers() does.
std::vector<AddressRange> buffer_ranges(const BoardConfig& board);

}  // namespace stereotlm::platform
