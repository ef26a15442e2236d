#include "models/memory/ssram_bank.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include "models/clock.h"

namespace stereotlm::memory {

SsramBank::SsramBank(const sc_core::sc_module_name& name, const SsramBankConfig& config)
    : sc_module(name), config_(config) {
  if (const auto found = problems(config); !found.empty()) {
    throw std::invalid_argument(std::string(this->name()) + ": " + found.front());
  }
  const auto latency = static_cast<std::uint64_t>(read_latency_cycles(config.kind));
  read_time_ = Clock::to_time(Clock(config.clock_mhz).edge_ps(latency));
  words_.reset(static_cast<std::uint32_t*>(std::calloc(config.words, sizeof(std::uint32_t))));
  if (words_ == nullptr) throw std::bad_alloc();
  port.bind(*this);
}

tlm::tlm_response_status SsramBank::check(const tlm::tlm_generic_payload& access) const {
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  if (access.get_data_length() != 4 || access.get_streaming_width() < 4) return tlm::TLM_BURST_ERROR_RESPONSE;
  if (access.get_address() % 4 != 0 || access.get_address() >= bytes())
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
  auto* stored = reinterpret_cast<unsigned char*>(words_.get() + access.get_address() / 4);
  unsigned char* data = access.get_data_ptr();
  const bool reads = access.is_read();
  if (const unsigned char* enables = access.get_byte_enable_ptr()) {
    const unsigned length = access.get_byte_enable_length();
    for (unsigned byte = 0; byte < 4; ++byte) {
      if (enables[byte % length] != TLM_BYTE_ENABLED) continue;
      (reads ? data[byte] : stored[byte]) = reads ? stored[byte] : data[byte];
    }
  } else if (reads) {
    std::memcpy(data, stored, 4);
  } else {
    std::memcpy(stored, data, 4);
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

unsigned SsramBank::transport_dbg(tlm::tlm_generic_payload& access) {
  const std::uint64_t address = access.get_address();
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND || address >= bytes()) return 0;
  const auto length =
      static_cast<unsigned>(std::min<std::uint64_t>(access.get_data_length(), bytes() - address));
  auto* stored = reinterpret_cast<unsigned char*>(words_.get()) + address;
  if (access.is_read()) {
    std::memcpy(access.get_data_ptr(), stored, length);
  } else {
    std::memcpy(stored, access.get_data_ptr(), length);
  }
  return length;
}

bool SsramBank::get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) {
  if (access.get_address() >= bytes()) {
    dmi.allow_read_write();
    dmi.set_start_address(bytes());
    dmi.set_end_address(UINT64_MAX);
    return false;
  }
  dmi.set_dmi_ptr(reinterpret_cast<unsigned char*>(words_.get()));
  dmi.set_start_address(0);
  dmi.set_end_address(bytes() - 1);
  dmi.allow_read_write();
  dmi.set_read_latency(read_time_);
  dmi.set_write_latency(sc_core::SC_ZERO_TIME);
  return true;
}

}  // namespace stereotlm::memory
