#pragma once

#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/memory/memory_config.h"
#include "models/memory/ram.h"

namespace stereotlm::memory {

// One synchronous SRAM bank: one 32-bit word per access, byte enables. b_transport never waits. A read adds
// to `delay` the time until its reader can use the word; a write adds nothing. nb_transport_fw has the same
// effect and returns TLM_COMPLETED. The arbiter in front of the bank decides which port may access it. A
// bank with separate ports has one socket too: of a read and a write in one cycle the initiators make the
// read first.
//
// Errors have no effect and add no delay:
//   TLM_ADDRESS_ERROR_RESPONSE      an address outside the bank, or not a multiple of 4
//   TLM_BURST_ERROR_RESPONSE        a length other than 4, or a streaming width below 4
//   TLM_BYTE_ENABLE_ERROR_RESPONSE  byte enables of length 0
//   TLM_COMMAND_ERROR_RESPONSE      a command that neither reads nor writes
//
// Debug transport takes any length. DMI grants the whole bank, read and write, and is never revoked. Words
// are in the byte order of the host computer.
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
  // The stored words, for the owner of the bank.
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
