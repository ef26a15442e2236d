#pragma once

#include <cstdint>

namespace stereotlm::platform {

// Where the devices of the computer lie on its PCI bus, in bytes (ours: in a real machine the BIOS decides).
struct DeviceMap {
  std::uint64_t host_memory = 0x0000'0000;
  std::uint64_t bridge_slave = 0xD000'0000;      // pci/bridge_registers.h
  std::uint64_t bridge_registers = 0xE000'0000;  // pci/bridge_registers.h
  std::uint64_t left_capture = 0xE100'0000;      // capture/capture_registers.h
  std::uint64_t right_capture = 0xE100'1000;
  std::uint64_t load = 0xE200'0000;  // the device of PciLoadConfig
};

}  // namespace stereotlm::platform
