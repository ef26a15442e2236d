#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/access_queue.h"
#include "models/pci/pci_slot_if.h"
#include "models/refusals.h"

namespace stereotlm::host {

// The bridge between a processor and the PCI bus. It turns each access into bursts at the same addresses.
// b_transport waits during the access, and returns when the last word has been transferred. The bridge
// repeats a retried burst and continues a cut one until all words have been transferred. Accesses of several
// processes are served in the order in which they arrive.
//
// | access                                                         | response                       |
// |----------------------------------------------------------------|--------------------------------|
// | no target responds (master abort)                              | TLM_ADDRESS_ERROR_RESPONSE     |
// | the target responds with an error                              | TLM_GENERIC_ERROR_RESPONSE     |
// | refused without a burst:                                       |                                |
// | an address that is not a multiple of 4                         | TLM_ADDRESS_ERROR_RESPONSE     |
// | a length of 0 or not a multiple of 4; streaming width < length | TLM_BURST_ERROR_RESPONSE       |
// | byte enables                                                   | TLM_BYTE_ENABLE_ERROR_RESPONSE |
// | neither read nor write                                         | TLM_COMMAND_ERROR_RESPONSE     |
//
// Words transferred before an error stay transferred. There is no DMI, and debug transport reaches nothing.
//
// If a process is killed or reset during its access, the access is lost, and reported (AccessQueue). A burst
// that has been granted the bus runs to its end, before the next access; any other is dropped.
class HostBridge : public sc_core::sc_module, private pci::PciMasterIf {
 public:
  tlm_utils::simple_target_socket<HostBridge> cpu{"cpu"};  // from the processor
  pci::PciMasterPort pci{"pci"};                           // to a slot of the bus

  explicit HostBridge(const sc_core::sc_module_name& name);  // all its sockets must be bound

 private:
  void transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  tlm::tlm_response_status transfer(tlm::tlm_generic_payload& access);
  pci::PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  void end_burst(const pci::BurstResult& result) override;

  enum class State { kIdle, kRequested, kGranted, kLost };  // of the burst; kLost: its access is lost

  AccessQueue queue_{*this};
  sc_core::sc_event ended_{"ended"};
  pci::PciBurst burst_;
  State state_ = State::kIdle;
  pci::BurstEnd end_ = pci::BurstEnd::kComplete;  // of the last burst
  unsigned done_bytes_ = 0;                       // of the access that is served
  std::vector<std::uint32_t> words_;
  Refusals refusals_{*this};
};

}  // namespace stereotlm::host
