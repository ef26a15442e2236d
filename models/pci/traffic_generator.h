#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <systemc>
#include <tlm>

#include "models/access_rules.h"
#include "models/checked.h"
#include "models/kernel_time.h"
#include "models/pci/pci_config.h"
#include "models/pci/pci_slot_if.h"
#include "models/pci/traffic_control.h"
#include "models/refusals.h"

namespace stereotlm::pci {

// A PCI master that loads the bus (TrafficGeneratorConfig). It reads from its own device, or from any other
// target at its address, and never writes. A transfer that the bus has cut, disconnected or retried continues
// immediately. An aborted transfer is reported with SC_REPORT_ERROR (type /stereotlm/traffic_generator) and
// is the last one.
class TrafficGenerator : public sc_core::sc_module {
 public:
  // To a slot of the bus.
  PciMasterPort pci{"pci", {}, [this](const std::exception& error) { report(error.what()); }};
  // The device, which stays unbound if the master reads from another target. A read of whole words without
  // byte enables returns zeros after access_ps. Other accesses are refused with the responses of
  // check_access(), a write with TLM_COMMAND_ERROR_RESPONSE.
  tlm_utils::simple_target_socket_optional<TrafficGenerator> device{"device"};

  // Throws std::invalid_argument if the configuration has problems.
  TrafficGenerator(const sc_core::sc_module_name& name, const TrafficGeneratorConfig& config)
      : sc_module(name), control_(checked(this->name(), config)), access_ps_(config.access_ps) {
    kernel_time::check_resolution(*this);
    device.register_b_transport(this, &TrafficGenerator::respond);
  }

 private:
  void report(const std::string& text) const {
    SC_REPORT_ERROR("/stereotlm/traffic_generator", (std::string(name()) + ": " + text).c_str());
  }
  void start_of_simulation() override { control_.start(pci); }
  void respond(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
    tlm::tlm_response_status status = check_access(access, {});
    if (access.is_write()) status = tlm::TLM_COMMAND_ERROR_RESPONSE;
    if (!refusals_.respond(access, status, {}, "must be a read")) return;
    std::memset(access.get_data_ptr(), 0, access.get_data_length());
    delay += kernel_time::to_time(access_ps_);
  }

  TrafficControl control_;
  std::uint64_t access_ps_;
  Refusals refusals_{*this};
};

}  // namespace stereotlm::pci
