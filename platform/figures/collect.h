#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "models/capture/capture_control.h"
#include "models/fpga/frame_run.h"
#include "models/fpga/host_port.h"
#include "models/fpga/local_bus_control.h"
#include "models/fpga/port_cycles.h"
#include "models/memory/arbitration.h"
#include "models/pci/bridge_control.h"
#include "models/pci/pci_bus_control.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/figures/bounds.h"
#include "platform/figures/derived_figures.h"
#include "platform/figures/statistics.h"

namespace stereotlm::platform {

// Counters of a board's modules, summed over the finished frames. They must be taken between two frames,
// because the modules count during a frame. The cost of taking them does not depend on the number of frames.
struct BoardCounters {
  // The counters of a bank.
  struct Bank {
    memory::ArbiterStats arbiter;  // grants and stalls
    std::uint64_t accesses = 0;    // accesses that reached the bank, including those that it refused
  };
  std::size_t frames = 0;                   // finished frames
  std::vector<fpga::PortCycles> ports;      // [port]
  std::vector<Bank> banks;                  // in the order of the configuration
  std::array<std::uint64_t, 2> issued{};    // [side]: slots that the sequencer has issued
  std::array<std::uint64_t, 2> consumed{};  // [side]: slots that the matcher has consumed
  std::uint64_t packed_words = 0;           // result words that were packed
  std::uint64_t written_words = 0;          // result words that were written
  AddressRange ahead;                       // HostPort::counted_ahead_of()
};

// Of a core without stages: all its frames work directly on memory. With a host: outside frames in the cycles
// before `end_cycle`. Those of a Board are in platform/assembly/board.h.
BoardCounters counters_of(const fpga::FrameRun& frames, const memory::Arbitration& arbitration,
                          const fpga::HostPort* host = nullptr, std::uint64_t end_cycle = 0);

// Returns the figures of the frames that `counters` cover; if there are any, also core_bound() of the board.
// Checks the identities of contract section 6; Statistics::failed lists those that do not hold.
// `frame_cycles`: the length of each frame.
Statistics collect_statistics(const BoardConfig& config, const FrameAccesses& accesses,
                              const std::string& fidelity, const std::vector<std::uint64_t>& frame_cycles,
                              const BoardCounters& counters);

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
  // A camera and its capture board.
  struct Camera {
    std::uint64_t frames = 0;  // frames that have begun
    bool undecided = false;    // the last frame began just now, and it is not decided whether it is captured
    capture::CaptureControl::Stats capture;  // counts of the capture board
  };

  BoardCounters board;                     // core, banks and ports
  pci::PciBusControl::Stats pci;           // of the PCI bus
  pci::BridgeControl::Stats bridge;        // of the bridge
  fpga::LocalBusControl::Stats local_bus;  // counts of the local bus
  Words words;                             // on their way to the board
  std::array<Camera, 2> cameras;           // the left one, then the right one
};

// What the PCI masters have transferred for results. The words of the traffic generator do not count.
std::uint64_t words_for_results(const pci::PciBusControl::Stats& bus);

// Returns the figures and the bounds of a run that ended with the last of `deliveries`. Checks the identities
// of contract section 6; Statistics::failed lists those that do not hold. `counters` were taken at the end of
// the run. `deliveries` has one entry for each frame in `counters`, at least one. `frame_cycles`: the length
// of each frame of the core.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const std::string& fidelity,
                              const std::vector<std::uint64_t>& frame_cycles,
                              const ComputerCounters& counters, const std::vector<Delivery>& deliveries);

}  // namespace stereotlm::platform
