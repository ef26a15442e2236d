#pragma once

#include <cstdint>
#include <string>
#include <systemc>
#include <tlm>

#include "models/kernels/integer_rule.h"
#include "models/memory/ram.h"

namespace stereotlm::host {

inline constexpr kernels::IntegerRule kHostMemoryRule{4, std::int64_t{1} << 31, 4};  // bytes

// The memory of the host (memory::RamTarget), for any number of initiators. An access transfers any whole
// number of 32-bit words, with or without byte enables, and takes no time, because the bus in front of the
// memory models the time.
class HostMemory : public sc_core::sc_module {
 public:
  using Stats = memory::RamTarget::Stats;  // accesses since time 0

  tlm::tlm_target_socket<32, tlm::tlm_base_protocol_types, 0> port{"port"};  // for any number of initiators

  // Throws std::invalid_argument if `bytes` breaks kHostMemoryRule.
  HostMemory(const sc_core::sc_module_name& name, std::uint64_t bytes)
      : sc_module(name),
        target_({kHostMemoryRule.required(std::string(this->name()) + ": bytes", bytes), false, true},
                "/stereotlm/host_memory", *this) {
    port.bind(target_);
  }

  // The stored bytes, for the owner of the memory.
  unsigned char* data() { return target_.ram().data(); }

  const Stats& stats() const { return target_.stats(); }  // counts up to the present time

 private:
  memory::RamTarget target_;
};

}  // namespace stereotlm::host
