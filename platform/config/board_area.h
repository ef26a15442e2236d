#pragma once

#include <string>
#include <vector>

#include "models/area/area.h"
#include "platform/config/board_config.h"

namespace stereotlm::platform {

// The FPGA of this board.
const area::Device& device_of(const BoardConfig& board);

// The FPGA resources of the core, for each kind of part and in total. No simulation is needed.
std::vector<area::Item> area_items(const BoardConfig& board);
area::Area area_of(const BoardConfig& board);

// "device xc2v6000: fits; the smallest that fits: xc2v1500".
std::string device_text(const BoardConfig& board);

// A remark on a clock above that of the paper's core; empty for any other.
std::string clock_remark(const BoardConfig& board);

}  // namespace stereotlm::platform
