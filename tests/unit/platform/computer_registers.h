#pragma once

#include <array>
#include <cstdint>

#include "models/fpga/register_map.h"
#include "models/pci/bridge_registers.h"
#include "platform/config/device_map.h"

// Addresses of the computer for its tests.
namespace stereotlm::platform::testing {

inline constexpr DeviceMap kDevices;
inline constexpr std::array<std::uint64_t, 2> kCaptures = {kDevices.left_capture, kDevices.right_capture};

constexpr std::uint64_t core_register(std::uint64_t address) {
  return kDevices.bridge_slave + pci::bridge::kCoreRegisters + address;
}
constexpr std::uint64_t dma_register(std::uint64_t channel, std::uint64_t address) {
  return kDevices.bridge_registers + pci::bridge::kChannelStride * channel + address;
}
// The first word that an aperture of the slave window shows.
constexpr std::uint64_t aperture(std::uint64_t number) {
  return kDevices.bridge_slave + number * pci::bridge::kApertureBytes;
}
constexpr std::uint64_t page_register(std::uint64_t number) {
  return kDevices.bridge_registers + pci::bridge::kPage + 4 * number;
}

// The registers of a frame's buffers: pictures, disparities and tables.
inline constexpr std::array<std::uint64_t, 5> kBaseRegisters = {
    fpga::registers::kLeftImageBase, fpga::registers::kRightImageBase, fpga::registers::kDisparityBase,
    fpga::registers::kLeftLutBase, fpga::registers::kRightLutBase};

}  // namespace stereotlm::platform::testing
