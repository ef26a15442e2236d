#include "models/host/host_memory.h"

#include <stdexcept>
#include <string>

namespace stereotlm::host {
namespace {

std::uint64_t checked(const char* name, std::uint64_t bytes) {
  const auto value = static_cast<std::int64_t>(bytes);
  if (!kHostMemoryRule.allows(value)) {
    throw std::invalid_argument(std::string(name) + ": " + kHostMemoryRule.problem("bytes", value));
  }
  return bytes;
}

}  // namespace

HostMemory::HostMemory(const sc_core::sc_module_name& name, std::uint64_t bytes)
    : sc_module(name), ram_(checked(this->name(), bytes)) {
  port.bind(*this);
}

tlm::tlm_response_status HostMemory::check(const tlm::tlm_generic_payload& access) const {
  const unsigned length = access.get_data_length();
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  if (length == 0 || length % 4 != 0 || access.get_streaming_width() < length)
    return tlm::TLM_BURST_ERROR_RESPONSE;
  if (access.get_address() % 4 != 0 || !ram_.holds(access.get_address(), length))
    return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  if (access.get_byte_enable_ptr() != nullptr && access.get_byte_enable_length() == 0)
    return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

void HostMemory::b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& /*delay*/) {
  const tlm::tlm_response_status status = check(access);
  access.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE) {
    ++stats_.errors;
    return;
  }
  access.set_dmi_allowed(true);
  ram_.move(access);
  ++(access.is_read() ? stats_.reads : stats_.writes);
}

tlm::tlm_sync_enum HostMemory::nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                               sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_REQ)
    SC_REPORT_ERROR("/stereotlm/host_memory", "nb_transport_fw: only BEGIN_REQ is expected");
  b_transport(access, delay);
  return tlm::TLM_COMPLETED;
}

}  // namespace stereotlm::host
