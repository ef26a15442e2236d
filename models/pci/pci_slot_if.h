#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <systemc>
#include <tlm>

#include "models/access_rules.h"
#include "models/kernel_time.h"
#include "models/pci/pci_slot.h"

// The sockets between the PCI bus and its masters and targets.
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

// Makes the access of a transaction to the registers of a control, which lie below `end`. Responses: those of
// check_access(), and TLM_COMMAND_ERROR_RESPONSE if the register does not have this direction.
inline void access_registers(PciTarget& registers, std::uint64_t end, tlm::tlm_generic_payload& access,
                             const sc_core::sc_time& delay) {
  tlm::tlm_response_status status = check_access(access, registers_below(end));
  const bool is_one_word = status == tlm::TLM_OK_RESPONSE;
  std::uint32_t word = 0;
  if (is_one_word && access.is_write()) std::memcpy(&word, access.get_data_ptr(), 4);
  const std::uint64_t now_ps = kernel_time::now_ps();
  // The control counts what it refuses, an access of no word too.
  const bool ok = registers
                      .access(now_ps, {access.is_write(), access.get_address(), &word, is_one_word ? 1U : 0U},
                              now_ps + kernel_time::to_ps(delay))
                      .ok;
  if (ok && access.is_read()) std::memcpy(access.get_data_ptr(), &word, 4);
  if (is_one_word && !ok) status = tlm::TLM_COMMAND_ERROR_RESPONSE;
  access.set_response_status(status);
}

}  // namespace stereotlm::pci
