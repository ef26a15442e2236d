#pragma once

#include <cstdint>

#include "models/fpga/local_bus_control.h"
#include "models/pci/pci_bus_control.h"

namespace stereotlm::platform {

// What the two buses of the bridge have done, up to a time or since a time.
struct BusCounts {
  std::uint64_t transactions = 0;  // on the PCI bus, of all masters
  std::uint64_t pci_busy = 0;      // clocks
  std::uint64_t bursts = 0;        // on the local bus
  std::uint64_t local_busy = 0;    // clocks

  // While the local bus is idle.
  static BusCounts of(const pci::PciBusControl& pci, const fpga::LocalBusControl& local) {
    return {pci.transactions(), pci.busy_clocks(), local.bursts(), local.busy_clocks()};
  }
  BusCounts since(const BusCounts& before) const {
    return {transactions - before.transactions, pci_busy - before.pci_busy, bursts - before.bursts,
            local_busy - before.local_busy};
  }
};

}  // namespace stereotlm::platform
