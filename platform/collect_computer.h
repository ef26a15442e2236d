#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/capture/capture_control.h"
#include "models/fpga/local_bus_control.h"
#include "models/pci/bridge_control.h"
#include "models/pci/pci_bus_control.h"
#include "platform/collect.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/figures.h"
#include "platform/statistics.h"

namespace stereotlm::platform {

// Counters of a computer's modules up to now. They must be taken while the core runs no frame.
struct ComputerCounters {
  // Words that are written to the board through the bridge. Each list has one entry per buffer, in the order
  // of buffers() in buffer_layout.h, and a last entry for words outside all buffers.
  struct Words {
    std::vector<std::uint64_t> into_bridge;  // words that the bridge has taken
    std::vector<std::uint64_t> in_bridge;    // words that wait in the bridge
    std::vector<std::uint64_t> on_bus;       // words of the burst on the local bus that are not granted yet
    std::vector<std::uint64_t> granted;      // words granted to the host port
  };
  struct Camera {
    std::uint64_t frames = 0;  // frames that have begun
    bool undecided = false;    // the last frame began just now, and it is not decided whether it is captured
    capture::CaptureControl::Stats capture;
  };

  BoardCounters board;
  pci::PciBusControl::Stats pci;
  pci::BridgeControl::Stats bridge;
  fpga::LocalBusControl::Stats local_bus;
  Words words;
  std::array<Camera, 2> cameras;  // left, right
};

// What the PCI masters have transferred for results. The words of the traffic generator do not count.
std::uint64_t words_for_results(const pci::PciBusControl::Stats& bus);

// Returns the figures and the bounds of a run that ended with the last of `deliveries`. Checks the identities
// of contract section 6; Statistics::failed lists those that do not hold. `counters` were taken at the end of
// the run. `deliveries` has one entry for each frame that they cover, at least one. `frame_cycles`: the length
// of each frame of the core.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const std::string& fidelity,
                              const std::vector<std::uint64_t>& frame_cycles,
                              const ComputerCounters& counters, const std::vector<Delivery>& deliveries);

}  // namespace stereotlm::platform
