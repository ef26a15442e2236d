#include "models/pci/traffic_generator.h"

#include <cstring>
#include <stdexcept>
#include <string>

#include "models/checked.h"
#include "models/kernel_time.h"

namespace stereotlm::pci {

TrafficGenerator::TrafficGenerator(const sc_core::sc_module_name& name, const TrafficGeneratorConfig& config)
    : sc_module(name), control_(checked(this->name(), config)), access_ps_(config.access_ps) {
  device.register_b_transport(this, &TrafficGenerator::respond);
}

void TrafficGenerator::end_burst(const BurstResult& result) {
  try {
    control_.end_burst(result);
  } catch (const std::runtime_error& error) {
    SC_REPORT_ERROR("/stereotlm/traffic_generator", (std::string(name()) + ": " + error.what()).c_str());
  }
}

void TrafficGenerator::respond(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  if (!access.is_read()) {
    access.set_response_status(tlm::TLM_COMMAND_ERROR_RESPONSE);
  } else if (access.get_data_length() % 4 != 0 || access.get_streaming_width() < access.get_data_length()) {
    access.set_response_status(tlm::TLM_BURST_ERROR_RESPONSE);
  } else if (access.get_byte_enable_ptr() != nullptr) {
    access.set_response_status(tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
  } else {
    std::memset(access.get_data_ptr(), 0, access.get_data_length());
    delay += kernel_time::to_time(access_ps_);
    access.set_response_status(tlm::TLM_OK_RESPONSE);
  }
}

}  // namespace stereotlm::pci
