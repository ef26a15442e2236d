#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace stereotlm::area {

// The resources of an FPGA (Xilinx DS031). A slice holds two 4-input look-up tables and the two flip-flops
// behind them.
struct Device {
  std::string_view name;
  std::int64_t slices;
  std::int64_t block_rams;   // of 18 kbit
  std::int64_t multipliers;  // 18 x 18 bit
};

// The devices that a board may name.
inline constexpr std::array<Device, 1> kDevices = {{{"xc2v6000", 33'792, 144, 144}}};

// Returns the device of this name, or null.
inline const Device* find_device(std::string_view name) {
  for (const Device& device : kDevices) {
    if (device.name == name) return &device;
  }
  return nullptr;
}

}  // namespace stereotlm::area
