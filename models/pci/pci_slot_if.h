#pragma once

#include <cstddef>
#include <cstdint>
#include <systemc>

#include "models/kernel_time.h"
#include "models/pci/pci_slot.h"

// The sockets between the PCI bus and its masters.
namespace stereotlm::pci {

class PciSlotIf : public virtual sc_core::sc_interface, public PciSlot {
 public:
  using PciSlot::request;
  // Requests the bus from now on.
  void request(PciMasterIf& master) { request(master, kernel_time::now_ps()); }
};

// Sockets of the slot: `capture.pci.bind(bus.slots[0])`.
using PciMasterPort = sc_core::sc_port<PciSlotIf>;
using PciSlotExport = sc_core::sc_export<PciSlotIf>;

// STOP#, which the base protocol has no phase for. A target without it takes bursts of any length.
class PciStopIf : public virtual sc_core::sc_interface {
 public:
  // Called at the address clock of a write. Returns how many of its `words` words the target takes, 0..words.
  virtual std::size_t writable_words(std::uint64_t address, std::size_t words) const = 0;
};

}  // namespace stereotlm::pci
