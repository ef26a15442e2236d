#pragma once

#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/checked.h"
#include "models/clock.h"
#include "models/kernel_time.h"
#include "models/memory/memory_config.h"
#include "models/memory/ram.h"

namespace stereotlm::memory {

// One synchronous SRAM bank, or one of SDRAM (RamTarget): one 32-bit word per access, with or without byte
// enables. A read takes the time until its reader can use the word. The arbiter in front of the bank decides
// which port may access it. A bank with separate ports also has one socket: if a cycle has a read and a
// write, the initiators read first. Words are in the byte order of the host computer.
class SsramBank : public sc_core::sc_module {
 public:
  using Stats = RamTarget::Stats;  // accesses since time 0

  tlm::tlm_target_socket<32> port{"port"};  // from the arbiter

  // Throws std::invalid_argument if the configuration has problems.
  SsramBank(const sc_core::sc_module_name& name, const SsramBankConfig& config)
      : sc_module(name),
        config_(checked(this->name(), config)),
        target_({std::uint64_t{config.words} * 4, true, true}, read_time(config), "/stereotlm/ssram_bank") {
    port.bind(target_);
  }

  const SsramBankConfig& config() const { return config_; }  // as given
  const Stats& stats() const { return target_.stats(); }     // up to now
  // The stored words, for the owner of the bank.
  const std::uint32_t* words() const { return reinterpret_cast<const std::uint32_t*>(target_.ram().data()); }

 private:
  static sc_core::sc_time read_time(const SsramBankConfig& config) {
    kernel_time::check_resolution();
    const auto cycles = static_cast<std::uint64_t>(read_latency_cycles(config));
    return kernel_time::to_time(Clock(config.clock_mhz).edge_ps(cycles));
  }

  SsramBankConfig config_;
  RamTarget target_;
};

}  // namespace stereotlm::memory
