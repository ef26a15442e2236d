#pragma once

#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/memory/memory_config.h"
#include "models/memory/ram.h"

namespace stereotlm::memory {

// One synchronous SRAM bank: a single port, one 32-bit word an access, byte enables. b_transport never waits;
// it adds the time from the access to the cycle in which the word is usable to `delay` (a write is done in
// its own cycle). Errors, all without effect and without cost: an address that is not a multiple of 4 or
// outside the bank is answered TLM_ADDRESS_ERROR_RESPONSE, a length other than 4 or a streaming width below
// it TLM_BURST_ERROR_RESPONSE, byte enables of length 0 TLM_BYTE_ENABLE_ERROR_RESPONSE, a command that
// neither reads nor writes TLM_COMMAND_ERROR_RESPONSE. nb_transport_fw completes at once, with the same
// effect. Who may access when is decided in front of the bank, by its arbiter. Debug transport takes any
// length; DMI grants the whole bank, read and write, and is never revoked. Words are in the host's byte
// order.
class SsramBank : public sc_core::sc_module, private tlm::tlm_fw_transport_if<> {
 public:
  struct Stats {
    std::uint64_t reads = 0;
    std::uint64_t writes = 0;
    std::uint64_t errors = 0;  // refused accesses
  };

  tlm::tlm_target_socket<32> port{"port"};

  // Throws std::invalid_argument if the configuration has problems.
  SsramBank(const sc_core::sc_module_name& name, const SsramBankConfig& config);

  const SsramBankConfig& config() const { return config_; }
  const Stats& stats() const { return stats_; }
  // The words, for whoever owns the bank.
  const std::uint32_t* words() const { return reinterpret_cast<const std::uint32_t*>(ram_.data()); }

 private:
  void b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) override;
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  unsigned transport_dbg(tlm::tlm_generic_payload& access) override;
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) override;
  tlm::tlm_response_status check(const tlm::tlm_generic_payload& access) const;

  SsramBankConfig config_;
  sc_core::sc_time read_time_;
  Ram ram_;
  Stats stats_;
};

}  // namespace stereotlm::memory
