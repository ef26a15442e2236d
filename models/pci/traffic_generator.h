#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/pci/pci_config.h"
#include "models/pci/pci_slot.h"

namespace stereotlm::pci {

// A third-party master that loads the bus (PciLoadConfig). It reads, so that it changes nothing in its
// target: either its own device, or any other that answers its address. A transfer that was cut, disconnected
// or told to retry goes on at once. One that is aborted is reported with SC_REPORT_ERROR (type
// /stereotlm/traffic_generator) and is the last.
class TrafficGenerator : public sc_core::sc_module, private PciMasterIf {
 public:
  PciMasterPort pci{"pci"};
  // The device: any length of whole words reads as zeros, after access_ps; a write or another command is
  // answered TLM_COMMAND_ERROR_RESPONSE, another length or a streaming width below it
  // TLM_BURST_ERROR_RESPONSE, byte enables TLM_BYTE_ENABLE_ERROR_RESPONSE. Unbound if the load reads from
  // another target.
  tlm_utils::simple_target_socket_optional<TrafficGenerator> device{"device"};

  // Throws std::invalid_argument if the configuration has problems.
  TrafficGenerator(const sc_core::sc_module_name& name, const PciLoadConfig& config);

  std::uint64_t transfers() const { return transfers_; }  // completed

 private:
  PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  void end_burst(const BurstResult& result) override;
  void start_of_simulation() override { pci->request(*this, config_.first_request_ps); }
  void answer(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);

  PciLoadConfig config_;
  std::vector<std::uint32_t> words_;
  std::size_t words_done_ = 0;  // of the running transfer
  std::uint64_t transfers_ = 0;
};

}  // namespace stereotlm::pci
