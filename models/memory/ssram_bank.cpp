#include "models/memory/ssram_bank.h"

#include <cstring>
#include <stdexcept>
#include <string>

#include "models/clock.h"
#include "models/kernel_time.h"

namespace stereotlm::memory {

namespace {

const SsramBankConfig& checked(const char* name, const SsramBankConfig& config) {
  if (const auto found = problems(config); !found.empty()) {
    throw std::invalid_argument(std::string(name) + ": " + found.front());
  }
  return config;
}

}  // namespace

SsramBank::SsramBank(const sc_core::sc_module_name& name, const SsramBankConfig& config)
    : sc_module(name), config_(checked(this->name(), config)), ram_(std::uint64_t{config.words} * 4) {
  kernel_time::check_resolution();
  const auto latency = static_cast<std::uint64_t>(read_latency_cycles(config.kind));
  read_time_ = kernel_time::to_time(Clock(config.clock_mhz).edge_ps(latency));
  port.bind(*this);
}

tlm::tlm_response_status SsramBank::check(const tlm::tlm_generic_payload& access) const {
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  if (access.get_data_length() != 4 || access.get_streaming_width() < 4) return tlm::TLM_BURST_ERROR_RESPONSE;
  if (access.get_address() % 4 != 0 || access.get_address() >= ram_.bytes())
    return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  if (access.get_byte_enable_ptr() != nullptr && access.get_byte_enable_length() == 0) {
    return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  }
  return tlm::TLM_OK_RESPONSE;
}

void SsramBank::b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  const tlm::tlm_response_status status = check(access);
  access.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE) {
    ++stats_.errors;
    return;
  }
  access.set_dmi_allowed(true);
  const bool reads = access.is_read();
  unsigned char* stored = ram_.data() + access.get_address();
  if (access.get_byte_enable_ptr() != nullptr) {
    ram_.move(access);
  } else if (reads) {
    std::memcpy(access.get_data_ptr(), stored, 4);
  } else {
    std::memcpy(stored, access.get_data_ptr(), 4);
  }
  if (reads) {
    ++stats_.reads;
    delay += read_time_;
  } else {
    ++stats_.writes;
  }
}

tlm::tlm_sync_enum SsramBank::nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                              sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_REQ)
    SC_REPORT_ERROR("/stereotlm/ssram_bank", "nb_transport_fw: only BEGIN_REQ is expected");
  b_transport(access, delay);
  return tlm::TLM_COMPLETED;
}

unsigned SsramBank::transport_dbg(tlm::tlm_generic_payload& access) { return ram_.debug(access); }

bool SsramBank::get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) {
  return ram_.grant_dmi(access, read_time_, dmi);
}

}  // namespace stereotlm::memory
