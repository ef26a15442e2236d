#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace stereotlm::area {

// The resources of an FPGA (Xilinx DS031). A slice holds two 4-input look-up tables and the two flip-flops
// behind them.
struct Device {
  std::string_view name;     // in board files: "xc2v6000"
  std::int64_t slices;       // of two look-up tables and two flip-flops each
  std::int64_t block_rams;   // of 18 kbit
  std::int64_t multipliers;  // 18 x 18 bit
};

// The devices that a board may name, smallest first.
inline constexpr std::array<Device, 7> kDevices = {{{"xc2v1000", 5'120, 40, 40},
                                                    {"xc2v1500", 7'680, 48, 48},
                                                    {"xc2v2000", 10'752, 56, 56},
                                                    {"xc2v3000", 14'336, 96, 96},
                                                    {"xc2v4000", 23'040, 120, 120},
                                                    {"xc2v6000", 33'792, 144, 144},
                                                    {"xc2v8000", 46'592, 168, 168}}};

// The operation frequency that the paper's core reached on an xc2v6000, by its Table 2.
inline constexpr double kPaperClockMhz = 40;

// Returns the device of this name, or null.
inline const Device* find_device(std::string_view name) {
  for (const Device& device : kDevices) {
    if (device.name == name) return &device;
  }
  return nullptr;
}

}  // namespace stereotlm::area
