#pragma once

#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/kernels/integer_rule.h"
#include "models/memory/ram.h"

namespace stereotlm::host {

inline constexpr kernels::IntegerRule kHostMemoryRule{4, std::int64_t{1} << 31, 4};

// The memory of the host, for any number of initiators. An access transfers any whole number of 32-bit words,
// with or without byte enables. b_transport adds no delay, because the bus in front of the memory models the
// time, and never waits. Refused accesses have no effect:
//
// | access                                                       | response                       |
// |--------------------------------------------------------------|--------------------------------|
// | an address that is not a multiple of 4, a byte outside       | TLM_ADDRESS_ERROR_RESPONSE     |
// | a length of 0 or not a multiple of 4, a smaller stream width | TLM_BURST_ERROR_RESPONSE       |
// | byte enables of length 0                                     | TLM_BYTE_ENABLE_ERROR_RESPONSE |
// | neither read nor write                                       | TLM_COMMAND_ERROR_RESPONSE     |
//
// nb_transport_fw has the same effect and returns TLM_COMPLETED. Debug transport takes any length. DMI grants
// the whole memory, for reads and writes, and is never revoked. The memory holds zeros at first; pages that
// were never touched occupy no memory of the simulating machine.
class HostMemory : public sc_core::sc_module, private tlm::tlm_fw_transport_if<> {
 public:
  struct Stats {
    std::uint64_t reads = 0;  // transactions; DMI and debug transport are not counted
    std::uint64_t writes = 0;
    std::uint64_t errors = 0;  // refused accesses
  };

  tlm::tlm_target_socket<32, tlm::tlm_base_protocol_types, 0> port{"port"};

  // Throws std::invalid_argument if `bytes` breaks kHostMemoryRule.
  HostMemory(const sc_core::sc_module_name& name, std::uint64_t bytes);

  // The stored bytes, for the owner of the memory.
  unsigned char* data() { return ram_.data(); }

  std::uint64_t bytes() const { return ram_.bytes(); }
  const Stats& stats() const { return stats_; }

 private:
  void b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) override;
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  unsigned transport_dbg(tlm::tlm_generic_payload& access) override { return ram_.debug(access); }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) override {
    return ram_.grant_dmi(access, sc_core::SC_ZERO_TIME, dmi);
  }
  tlm::tlm_response_status check(const tlm::tlm_generic_payload& access) const;

  memory::Ram ram_;
  Stats stats_;
};

}  // namespace stereotlm::host
