#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/area/device.h"
#include "models/area/parts.h"
#include "models/fpga/core_config.h"

// Estimates the FPGA resources that the stereo core takes, part by part. README.md says what is counted, and
// compares it with the synthesis of models/rtl.
namespace stereotlm::area {

// All parts of one kind, such as the column modules.
struct Item {
  std::string name;        // what the parts are, in messages and results
  std::int64_t count = 0;  // of parts
  Resources all;           // of all `count` parts

  std::int64_t lut_equivalents() const;  // places of a LUT and a flip-flop, which need not belong together
};

// The parts of the core with this configuration, in the order in which data passes through them. Parts that
// the configuration does not need are absent. Throws std::invalid_argument if the configuration has problems.
std::vector<Item> items(const fpga::CoreConfig& config);

// The resources of all items together. Percentages are shares of the device: the core does not fit if one of
// them is above 100.
struct Area {
  std::int64_t lut_equivalents = 0;                   // LUTs or flip-flops, whichever are more
  std::int64_t slices = 0;                            // of two lut_equivalents: full, the lower limit
  double slices_percent = 0;                          // of the device's slices
  std::int64_t luts = 0;                              // as in Resources
  std::int64_t flip_flops = 0;                        // as in Resources
  std::int64_t block_rams = 0;                        // of 18 kbit
  double block_rams_percent = 0;                      // of the device's block RAMs
  std::int64_t multipliers = 0;                       // multipliers of 18 x 18 bits
  double multipliers_percent = 0;                     // of the device's multipliers
  std::optional<std::int64_t> pins = std::nullopt;    // of a board that names its package
  std::optional<double> pins_percent = std::nullopt;  // of the package's user pins

  bool fits() const;  // whether the device has enough slices, block RAMs and multipliers
};
Area total(const std::vector<Item>& items, const Device& device);  // the sum, and its shares of the device

// The smallest device of the family that holds the area; null if none does.
const Device* smallest_device(const Area& area);

}  // namespace stereotlm::area
