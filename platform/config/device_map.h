#pragma once

#include <cstdint>

#include "models/capture/capture_registers.h"
#include "models/fpga/register_map.h"
#include "models/pci/bridge_registers.h"

namespace stereotlm::platform {

// Base addresses of the devices on the PCI bus, in bytes. They are a choice of this model; in a real machine
// the BIOS assigns them. A program on the host needs this header and those that the table names.
//
// | from        | holds                                                    | described in                |
// |-------------|----------------------------------------------------------|-----------------------------|
// | 0x0000'0000 | host memory                                              |                             |
// | 0xC000'0000 | the bridge's window to the board: four apertures of      | pci/bridge_registers.h      |
// |             | 64 MiB onto the banks, then the registers of the core    | fpga/register_map.h         |
// | 0xE000'0000 | the bridge's own registers: pages, interrupts, DMA       | pci/bridge_registers.h      |
// | 0xE100'0000 | the left capture board                                   | capture/capture_registers.h |
// | 0xE100'1000 | the right capture board                                  | capture/capture_registers.h |
// | 0xE200'0000 | the traffic generator (board key `pci.load`)             |                             |
struct DeviceMap {
  std::uint64_t host_memory = 0x0000'0000;        // grows upwards from 0
  std::uint64_t bridge_slave = 0xC000'0000;       // 256 MiB of apertures, then 4 KiB of core registers
  std::uint64_t bridge_registers = 0xE000'0000;   // pages, interrupts, DMA
  std::uint64_t left_capture = 0xE100'0000;       // capture board of the left camera
  std::uint64_t right_capture = 0xE100'1000;      // capture board of the right camera
  std::uint64_t traffic_generator = 0xE200'0000;  // only with `pci.load`
};

}  // namespace stereotlm::platform
