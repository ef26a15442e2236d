#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/fpga/core_ports.h"
#include "models/fpga/port_cycles.h"
#include "models/fpga/record/requesters.h"

namespace stereotlm::fpga {

// What a port does in one cycle.
struct PortCycle {
  Intent intent = Intent::kIdle;
  bool granted = false;       // of a request
  std::size_t bank = 0;       // of a request
  std::uint64_t address = 0;  // of a request: byte address in the bank
  std::size_t by = 0;         // of a request that waits: who is to blame, see Requesters
  std::uint64_t item = 0;     // number in its frame of the slot taken or handled, or of the word written
};

// One cycle of the core, as it is decided and arbitrated. The queues are as the cycle begins.
struct CoreCycle {
  std::uint64_t cycle = 0;             // since power-up
  std::optional<std::uint64_t> frame;  // the frame that runs; else only the host's port is set
  std::vector<PortCycle> ports;
  HostTraffic host_traffic = HostTraffic::kCapture;  // if the host requests
  std::vector<std::uint32_t> lane_slots;             // [lane]: CoreControl::lanes(); slots in the lane
  std::uint32_t result_words = 0;                    // in the queue of results
  bool works = false;                                // the matcher works
};

// Receives the cycles of the core in a window, in their order. Cycles in which no frame runs and the host
// requests no bank are left out. Plain C++.
class CycleObserver {
 public:
  virtual ~CycleObserver() = default;
  virtual void cycle(const CoreCycle& cycle) = 0;
};

// The part of a run in which each cycle is observed.
struct CycleWindow {
  enum class Unit : std::uint8_t { kCycles, kRows };

  // The frame of the core. Without it the window may hold several, and cycles count from power-up.
  std::optional<std::uint64_t> frame;
  // Cycles of the frame, or since power-up; or rows of its results. A row has the cycles of its strip.
  Unit unit = Unit::kCycles;
  std::uint64_t first = 0;
  std::uint64_t last = UINT64_MAX;  // this one included
};

}  // namespace stereotlm::fpga
