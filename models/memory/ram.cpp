#include "models/memory/ram.h"

#include <algorithm>
#include <cstring>

#include "models/kernel_time.h"

namespace stereotlm::memory {

void RamTarget::b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  if (!refusals_.respond(access, check_access(access, rules_), rules_)) {
    ++stats_.errors;
    return;
  }
  access.set_dmi_allowed(true);
  move(access);
  const std::uint64_t words = access.get_data_length() / 4;
  (access.is_read() ? stats_.reads : stats_.writes) += words;
  if (!timing_) return;
  const std::uint64_t cycles = words - 1 + (access.is_read() ? timing_->read_cycles : 0);
  if (cycles == 0) return;
  const Clock& clock = timing_->clock;
  // Where the period is whole ps, the time does not depend on the first edge. This is for speed.
  if (cycles == timing_->read_cycles && clock.has_whole_period()) {
    delay += read_time_;
    return;
  }
  const std::uint64_t first = clock.edge_at_or_after(kernel_time::now_ps() + kernel_time::to_ps(delay));
  delay += kernel_time::to_time(clock.edge_ps(first + cycles) - clock.edge_ps(first));
}

// Moves the enabled bytes.
void RamTarget::move(tlm::tlm_generic_payload& access) {
  unsigned char* const stored = ram_.data() + access.get_address();
  unsigned char* const from = access.is_read() ? stored : access.get_data_ptr();
  unsigned char* const to = access.is_read() ? access.get_data_ptr() : stored;
  const unsigned length = access.get_data_length();
  const unsigned char* const enables = access.get_byte_enable_ptr();
  if (enables != nullptr) {
    const unsigned enable_length = access.get_byte_enable_length();
    for (unsigned byte = 0; byte < length; ++byte) {
      if (enables[byte % enable_length] == TLM_BYTE_ENABLED) to[byte] = from[byte];
    }
  } else if (length == 4) {
    std::memcpy(to, from, 4);  // without a call, for speed
  } else {
    std::memcpy(to, from, length);
  }
}

tlm::tlm_sync_enum RamTarget::nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                              sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_REQ) SC_REPORT_ERROR(report_, "nb_transport_fw: only BEGIN_REQ is expected");
  b_transport(access, delay);
  return tlm::TLM_COMPLETED;
}

// Moves the bytes that lie inside the memory, and returns their number.
unsigned RamTarget::transport_dbg(tlm::tlm_generic_payload& access) {
  const std::uint64_t address = access.get_address();
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND || address >= ram_.bytes()) return 0;
  const auto length =
      static_cast<unsigned>(std::min<std::uint64_t>(access.get_data_length(), ram_.bytes() - address));
  unsigned char* const stored = ram_.data() + address;
  unsigned char* const data = access.get_data_ptr();
  std::memcpy(access.is_read() ? data : stored, access.is_read() ? stored : data, length);
  return length;
}

// A refusal names the range behind the memory.
bool RamTarget::get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) {
  dmi.allow_read_write();
  if (access.get_address() >= ram_.bytes()) {
    dmi.set_start_address(ram_.bytes());
    dmi.set_end_address(UINT64_MAX);
    return false;
  }
  dmi.set_dmi_ptr(ram_.data());
  dmi.set_start_address(0);
  dmi.set_end_address(ram_.bytes() - 1);
  if (timing_) dmi.set_read_latency(kernel_time::to_time(timing_->clock.edge_ps(timing_->read_cycles)));
  dmi.set_write_latency(sc_core::SC_ZERO_TIME);
  return true;
}

}  // namespace stereotlm::memory
