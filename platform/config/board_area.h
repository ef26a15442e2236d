#pragma once

#include <string>
#include <vector>

#include "models/area/area.h"
#include "models/area/pins.h"
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

// The pins of each bank that holds a word of a buffer.
struct PinsOfBank {
  std::string bank;     // name of the bank
  area::BankPins pins;  // those of the FPGA that it takes
};
// In the order of the board file.
std::vector<PinsOfBank> bank_pins(const BoardConfig& board);
// Of the banks, the local bus, clocks and status.
int pins_of(const BoardConfig& board);

// The area of the core, as shares of the board's device.
area::Area area_of(const BoardConfig& board);

// "548 pins: ff1152 has 824, ff1517 1104"; with a package "548 of 824 pins of ff1152".
std::string pins_text(const BoardConfig& board);

// "device xc2v6000: fits; the smallest that fits: xc2v1500; 548 pins: ff1152 has 824, ff1517 1104".
std::string device_text(const BoardConfig& board);

// A remark on a clock above that of the paper's core; empty for any other.
std::string clock_remark(const BoardConfig& board);

}  // namespace stereotlm::platform
