#include "platform/config/board_area.h"

#include <fmt/format.h>

#include <algorithm>

#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {

std::vector<PinsOfBank> bank_pins(const BoardConfig& board) {
  const std::vector<memory::SsramBankConfig> configs = ssram_configs(board);
  const std::vector<bool> used = used_banks(board);
  std::vector<PinsOfBank> pins;
  for (std::size_t bank = 0; bank < configs.size(); ++bank) {
    if (used[bank]) pins.push_back({board.banks[bank].name, area::pins_of(configs[bank])});
  }
  return pins;
}

int pins_of(const BoardConfig& board) {
  int pins = area::kLocalBusPins + area::kOtherPins;
  for (const PinsOfBank& bank : bank_pins(board)) pins += bank.pins.all();
  return pins;
}

area::Area area_of(const BoardConfig& board) {
  area::Area area = area::total(area_items(board), device_of(board));
  if (const area::Package* const package = area::find_package(board.fpga.package)) {
    area.pins = pins_of(board);
    area.pins_percent = 100.0 * pins_of(board) / package->user_pins;
  }
  return area;
}

std::string pins_text(const BoardConfig& board) {
  if (const area::Package* const package = area::find_package(board.fpga.package))
    return fmt::format("{} of {} pins of {}", pins_of(board), package->user_pins, package->name);
  std::string text = fmt::format("{} pins", pins_of(board));
  if (board.fpga.device != area::kDeviceWithPackages) return text;
  const char* separator = ": ";
  for (const area::Package& package : area::kPackages) {
    text += fmt::format("{}{}{} {}", separator, package.name, separator[0] == ':' ? " has" : "",
                        package.user_pins);
    separator = ", ";
  }
  return text;
}

std::string device_text(const BoardConfig& board) {
  const area::Area area = area_of(board);
  const area::Device* const smallest = area::smallest_device(area);
  return fmt::format("device {}: {}; the smallest that fits: {}; {}", board.fpga.device,
                     area.fits() ? "fits" : "does not fit", smallest == nullptr ? "none" : smallest->name,
                     pins_text(board));
}

std::string clock_remark(const BoardConfig& board) {
  if (board.fpga.clock_mhz <= area::kPaperClockMhz) return "";
  return fmt::format(
      "fpga.clock_mhz = {}: above the {} MHz that the paper's core reached; nothing is placed or "
      "routed here, so whether this core reaches it is open",
      board.fpga.clock_mhz, area::kPaperClockMhz);
}

}  // namespace stereotlm::platform
