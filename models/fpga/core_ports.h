#pragma once

#include <array>
#include <cstdint>

#include "models/fpga/core_config.h"
#include "models/fpga/register_map.h"
#include "models/memory/memory_config.h"

namespace stereotlm::fpga {

enum class Side : std::uint8_t { kLeft, kRight };
inline constexpr std::array<Side, 2> kSides = {Side::kLeft, Side::kRight};
constexpr std::size_t index_of(Side side) { return static_cast<std::size_t>(side); }

constexpr memory::Port lut_port(Side side) {
  return side == Side::kLeft ? memory::Port::kLeftLut : memory::Port::kRightLut;
}
constexpr memory::Port pixel_port(Side side) {
  return side == Side::kLeft ? memory::Port::kLeftPixel : memory::Port::kRightPixel;
}

// One of the core's own ports on the banks. In a frame it accesses one buffer, in one direction.
struct CorePort {
  const char* buffer;             // name of the buffer
  std::uint64_t base_register;    // register_map.h: bank and first word of the buffer
  std::uint64_t bytes_per_pixel;  // of the buffer
  bool write;                     // direction of all its accesses
  bool CoreConfig::*needs;        // the port exists if this is true; null: always
};

// The core's own ports come before the host's.
inline constexpr std::size_t kCorePortCount = memory::index_of(memory::Port::kHost);

// [memory::index_of(Port)]
inline constexpr std::array<CorePort, kCorePortCount> kCorePorts = {{
    {"left_lut", registers::kLeftLutBase, 4, false, &CoreConfig::left_table},
    {"right_lut", registers::kRightLutBase, 4, false, &CoreConfig::right_table},
    {"left_image", registers::kLeftImageBase, 1, false, nullptr},
    {"right_image", registers::kRightImageBase, 1, false, nullptr},
    {"disparity", registers::kDisparityBase, 1, true, nullptr},
}};

constexpr bool has_port(const CoreConfig& config, std::size_t port) {
  return kCorePorts[port].needs == nullptr || config.*kCorePorts[port].needs;
}

// The base registers of one frame: for each port the bank and the first word of its buffer, as in
// register_map.h. Without meaning for a port that the core does not have.
using FrameBases = std::array<std::uint32_t, kCorePortCount>;

}  // namespace stereotlm::fpga
