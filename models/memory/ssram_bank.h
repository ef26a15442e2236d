#pragma once

#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/memory/memory_config.h"
#include "models/memory/ram.h"

namespace stereotlm::memory {

// One synchronous SRAM bank (RamTarget): one 32-bit word per access, with or without byte enables. A read
// takes the time until its reader can use the word. The arbiter in front of the bank decides which port may
// access it. A bank with separate ports has one socket too: of a read and a write in one cycle the initiators
// make the read first. Words are in the byte order of the host computer.
class SsramBank : public sc_core::sc_module {
 public:
  using Stats = RamTarget::Stats;

  tlm::tlm_target_socket<32> port{"port"};

  // Throws std::invalid_argument if the configuration has problems.
  SsramBank(const sc_core::sc_module_name& name, const SsramBankConfig& config);

  const SsramBankConfig& config() const { return config_; }
  const Stats& stats() const { return target_.stats(); }
  // The stored words, for the owner of the bank.
  const std::uint32_t* words() const { return reinterpret_cast<const std::uint32_t*>(target_.ram().data()); }

 private:
  SsramBankConfig config_;
  RamTarget target_;
};

}  // namespace stereotlm::memory
