#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/area/device.h"
#include "models/area/parts.h"
#include "models/fpga/core_config.h"

// What the stereo core takes of its FPGA. The structure is counted: which adders, comparators, shift
// registers and memories there are follows from the paper's figures 5, 6 and 8 and the contract's sections 1
// and 2, and how wide they are from the pixels' 8 bits, the window and the disparities. One constant, for how
// well LUTs fill slices, is fitted to the paper's Table 2 (sw/explore/area_fit.h).
//
// Counted is what pixels, table entries, sums and disparities pass through. Not counted is what steers them:
// counters, the addresses of tables and results, the repetition of edge pixels, arbiters and the multiplexers
// of the banks, registers, the local bus. None of it grows with the disparities.
namespace stereotlm::area {

// Parts of the same kind.
struct Item {
  std::string name;
  std::int64_t count = 0;
  Resources all;  // of all of them together

  // Places for a LUT and the flip-flop behind it: within an item each flip-flop is behind a LUT as long as
  // there are any.
  std::int64_t lut_equivalents() const;
};

// Of the core with this configuration, in the order of the data, without what it does not need. Throws
// std::invalid_argument if the configuration has problems.
std::vector<Item> items(const fpga::CoreConfig& config);

// Slices a LUT-equivalent; 0.5 would be two in every slice. From the least squares of the three rows of Table
// 2.
inline constexpr double kSlicesPerLutEquivalent = 0.6218;

// The sum of items. Percentages of what the device has; above 100 the core does not fit.
struct Area {
  std::int64_t lut_equivalents = 0;
  std::int64_t slices = 0;  // rounded up
  double slices_percent = 0;
  std::int64_t luts = 0;
  std::int64_t flip_flops = 0;
  std::int64_t block_rams = 0;
  double block_rams_percent = 0;
  std::int64_t multipliers = 0;
  double multipliers_percent = 0;

  bool fits() const {
    return slices_percent <= 100 && block_rams_percent <= 100 && multipliers_percent <= 100;
  }
};
Area total(const std::vector<Item>& items, const Device& device);

}  // namespace stereotlm::area
