#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "models/capture/capture_config.h"
#include "models/pci/pci_config.h"
#include "platform/config/board_config.h"

// The parts of a computer around the board, as Computer and ComputerLoop build them. Plain data.
namespace stereotlm::platform {

// Masters of the PCI bus: indices of its slots and of its statistics.
enum PciMaster : std::size_t { kHost, kLeftCapture, kRightCapture, kBridge, kTrafficGenerator };
inline constexpr std::array<const char*, 5> kPciMasterNames = {"host", "left_capture", "right_capture",
                                                               "bridge", "load"};
// Windows of the PCI bus.
enum PciTargetWindow : std::size_t {
  kHostMemory,
  kBridgeSlave,
  kBridgeRegisters,
  kLeftRegisters,
  kRightRegisters,
  kTrafficDevice
};
inline constexpr std::array<const char*, 6> kPciTargetNames = {  // in the order of PciTargetWindow
    "host_memory", "bridge", "bridge_registers", "left_capture", "right_capture", "load"};

// Masters, windows and timing of the PCI bus.
pci::PciBusConfig pci_config(const BoardConfig& board, std::uint64_t host_memory_bytes);
pci::PciBridgeConfig bridge_config(const BoardConfig& board);          // the counted buffers included
capture::CameraConfig camera_config(const BoardConfig& board);         // for both cameras
capture::CaptureBoardConfig capture_config(const BoardConfig& board);  // for both capture boards
// Nothing on a board without `pci.load`. Such a bus has no master kTrafficGenerator.
std::optional<pci::TrafficGeneratorConfig> traffic_config(const BoardConfig& board);

}  // namespace stereotlm::platform
