#include "models/pci/traffic_generator.h"

#include <cstring>

#include "models/checked.h"
#include "models/kernel_time.h"

namespace stereotlm::pci {

TrafficGenerator::TrafficGenerator(const sc_core::sc_module_name& name, const TrafficGeneratorConfig& config)
    : sc_module(name), control_(checked(this->name(), config)), access_ps_(config.access_ps) {
  device.register_b_transport(this, &TrafficGenerator::respond);
}

void TrafficGenerator::respond(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  tlm::tlm_response_status status = check_access(access, {});
  if (access.is_write()) status = tlm::TLM_COMMAND_ERROR_RESPONSE;
  access.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE) return;
  std::memset(access.get_data_ptr(), 0, access.get_data_length());
  delay += kernel_time::to_time(access_ps_);
}

}  // namespace stereotlm::pci
