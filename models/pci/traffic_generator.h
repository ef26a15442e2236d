#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/pci/pci_config.h"
#include "models/pci/pci_slot_if.h"
#include "models/pci/traffic_control.h"

namespace stereotlm::pci {

// A PCI master that loads the bus (TrafficGeneratorConfig). It reads from its own device, or from any other
// target at its address, and never writes. A transfer that the bus has cut, disconnected or retried continues
// immediately. An aborted transfer is reported with SC_REPORT_ERROR (type /stereotlm/traffic_generator) and
// is the last one.
class TrafficGenerator : public sc_core::sc_module, private PciMasterIf, private PciSlot {
 public:
  PciMasterPort pci{"pci"};
  // The device, which stays unbound if the master reads from another target. A read of whole words without
  // byte enables returns zeros after access_ps. Other accesses are refused with the responses of
  // check_access(), a write with TLM_COMMAND_ERROR_RESPONSE.
  tlm_utils::simple_target_socket_optional<TrafficGenerator> device{"device"};

  // Throws std::invalid_argument if the configuration has problems.
  TrafficGenerator(const sc_core::sc_module_name& name, const TrafficGeneratorConfig& config);

 private:
  PciBurst begin_burst(std::uint64_t address_clock_ps) override {
    return control_.begin_burst(address_clock_ps);
  }
  void end_burst(const BurstResult& result) override;
  void start_of_simulation() override { control_.start(*this); }
  void respond(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);

  // The control calls these.
  void request(PciMasterIf& /*control*/, std::uint64_t from_ps) override { pci->request(*this, from_ps); }
  BurstResult transferred(std::uint64_t now_ps) const override { return pci->transferred(now_ps); }
  const Clock& clock() const override { return pci->clock(); }

  TrafficControl control_;
  std::uint64_t access_ps_;
};

}  // namespace stereotlm::pci
