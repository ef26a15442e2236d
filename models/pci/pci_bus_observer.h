#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace stereotlm::pci {

// A burst on the PCI bus that has ended. Each time is that at which a clock of the bus begins.
struct EndedPciBurst {
  std::size_t master = 0;             // its slot
  std::optional<std::size_t> window;  // none: a master abort
  bool write = false;
  std::uint64_t address = 0;     // on the bus
  std::uint64_t words = 0;       // transferred
  std::uint64_t request_ps = 0;  // the first clock that could have been granted to the master
  std::uint64_t address_ps = 0;  // the address clock
  std::uint64_t data_ps = 0;     // the clock after the address clock
  std::uint64_t end_ps = 0;      // the idle clock
};

// Receives the bursts of the PCI bus, for traces. Plain C++.
class PciBusObserver {
 public:
  virtual ~PciBusObserver() = default;
  // Called at the end of each burst.
  virtual void pci_burst_ended(const EndedPciBurst& burst) = 0;
};

}  // namespace stereotlm::pci
