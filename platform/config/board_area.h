#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "models/area/area.h"
#include "platform/config/board_config.h"

namespace stereotlm::platform {

// The FPGA of this board.
inline const area::Device& device_of(const BoardConfig& board) {
  return *area::find_device(board.fpga.device);
}

// The FPGA resources of the core, for each kind of part and in total. No simulation is needed.
inline std::vector<area::Item> area_items(const BoardConfig& board) {
  return area::items(core_config(board));
}
inline area::Area area_of(const BoardConfig& board) {
  return area::total(area_items(board), device_of(board));
}

// "device xc2v6000: fits; the smallest that fits: xc2v1500".
inline std::string device_text(const BoardConfig& board) {
  const area::Area area = area_of(board);
  const area::Device* const smallest = area::smallest_device(area);
  return fmt::format("device {}: {}; the smallest that fits: {}", board.fpga.device,
                     area.fits() ? "fits" : "does not fit", smallest == nullptr ? "none" : smallest->name);
}

// A remark on a clock above that of the paper's core; empty for any other.
inline std::string clock_remark(const BoardConfig& board) {
  if (board.fpga.clock_mhz <= area::kPaperClockMhz) return "";
  return fmt::format(
      "fpga.clock_mhz = {}: above the {} MHz that the paper's core reached; nothing is placed or "
      "routed here, so whether this core reaches it is open",
      board.fpga.clock_mhz, area::kPaperClockMhz);
}

}  // namespace stereotlm::platform
