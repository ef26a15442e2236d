#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/capture/capture_board.h"
#include "models/fpga/local_bus.h"
#include "models/pci/pci_bridge.h"
#include "models/pci/pci_bus.h"
#include "platform/collect.h"
#include "platform/computer.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/statistics.h"

namespace stereotlm::platform {

// When a delivered frame was captured and delivered, from time 0.
struct Delivery {
  std::uint64_t capture_ps = 0;  // its first pixel
  std::uint64_t host_ps = 0;     // the host has handled the end of its read-back
};

// What the parts of a computer have counted so far. To be taken while the core runs no frame.
struct ComputerCounters {
  // Words written to the buffers of the board; [buffer] in the order of buffers() in board_rules.h, then
  // those outside of all.
  struct Words {
    std::vector<std::uint64_t> into_bridge;
    std::vector<std::uint64_t> in_bridge;  // still, and not on the local bus
    std::vector<std::uint64_t> on_bus;     // of the burst on the local bus, not yet granted
    std::vector<std::uint64_t> granted;    // on the host port
  };
  struct Camera {
    std::uint64_t frames = 0;  // begun
    bool undecided = false;    // the last of them began just now
    capture::CaptureBoard::Stats capture;
  };

  BoardCounters board;
  pci::PciBus::Stats pci;
  pci::PciBridge::Stats bridge;
  fpga::LocalBus::Stats local_bus;
  Words words;
  std::array<Camera, 2> cameras;  // left, right
};

ComputerCounters counters_of(const Computer& computer);

// The figures of a run that ended with the last of `deliveries`, when `counters` were taken, with their
// bounds; the identities of contract section 6 are checked, and those that do not hold listed in `failed`.
// The board's counters and `deliveries` are of the same frames, at least one.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Computer& computer,
                              const ComputerCounters& counters, const std::vector<Delivery>& deliveries);

}  // namespace stereotlm::platform
