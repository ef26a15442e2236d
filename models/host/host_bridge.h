#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/pci/pci_slot.h"

namespace stereotlm::host {

// The bridge between a processor and the PCI bus: what the processor accesses becomes bursts at the same
// addresses. b_transport waits for the time of the access, and returns when the last word has been
// transferred; retries and what a burst left over are asked for again, as long as it takes. Accesses of
// several processes are served in the order in which they came.
//
// Responses: TLM_ADDRESS_ERROR_RESPONSE if no target answers (master abort), TLM_GENERIC_ERROR_RESPONSE if
// the target answers with an error; words transferred before that stay transferred. Refused without a burst:
// an address that is not a multiple of 4 (TLM_ADDRESS_ERROR_RESPONSE), a length that is not (or is 0) or a
// streaming width below it (TLM_BURST_ERROR_RESPONSE), byte enables (TLM_BYTE_ENABLE_ERROR_RESPONSE), a
// command that neither reads nor writes (TLM_COMMAND_ERROR_RESPONSE). There is no DMI, and debug transport
// reaches nothing.
class HostBridge : public sc_core::sc_module, private pci::PciMasterIf {
 public:
  tlm_utils::simple_target_socket<HostBridge> cpu{"cpu"};
  pci::PciMasterPort pci{"pci"};

  explicit HostBridge(const sc_core::sc_module_name& name);

 private:
  void transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  tlm::tlm_response_status transfer(tlm::tlm_generic_payload& access);
  pci::PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  void end_burst(const pci::BurstResult& result) override;

  // Turns in the order of arrival: a mutex can be won again and again by a process that never pauses.
  std::uint64_t arrived_ = 0;
  std::uint64_t served_ = 0;
  sc_core::sc_event next_turn_{"next_turn"};
  sc_core::sc_event ended_{"ended"};
  pci::PciBurst burst_;  // asked for, or running
  pci::BurstResult result_;
  std::vector<std::uint32_t> words_;
};

}  // namespace stereotlm::host
