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

// One synchronous SRAM bank, or one of SDRAM (RamTarget): 32-bit words, with or without byte enables. A read
// takes the time until its reader can use the word. A burst takes a cycle more for each further word; it
// knows no arbiter and no rows of SDRAM, which are the arbiter's. The arbiter in front of the bank decides
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
        target_({std::uint64_t{config.words} * 4, false, true}, "/stereotlm/ssram_bank", *this,
                RamTarget::Timing{Clock(config.clock_mhz),
                                  static_cast<std::uint64_t>(read_latency_cycles(config))}) {
    kernel_time::check_resolution(*this);
    port.bind(target_);
  }

  const SsramBankConfig& config() const { return config_; }  // the given configuration
  const Stats& stats() const { return target_.stats(); }     // counts up to the present time
  // The stored words, for the owner of the bank.
  const std::uint32_t* words() const { return reinterpret_cast<const std::uint32_t*>(target_.ram().data()); }

 private:
  SsramBankConfig config_;
  RamTarget target_;
};

}  // namespace stereotlm::memory
