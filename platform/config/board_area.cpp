#include "platform/config/board_area.h"

#include <stdexcept>

#include "platform/config/board_keys.h"

namespace stereotlm::platform {

const area::Device& device_of(const BoardConfig& board) {
  const area::Device* device = area::find_device(board.fpga.device);
  if (device == nullptr) {
    throw std::invalid_argument("fpga.device = " + board.fpga.device + ": " + rule_text("fpga.device"));
  }
  return *device;
}

std::vector<area::Item> area_items(const BoardConfig& board) { return area::items(core_config(board)); }

area::Area area_of(const BoardConfig& board) { return area::total(area_items(board), device_of(board)); }

}  // namespace stereotlm::platform
