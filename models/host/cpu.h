#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/host/program.h"
#include "models/interrupt.h"
#include "models/kernels/integer_rule.h"
#include "models/memory/word_access.h"

namespace stereotlm::host {

inline constexpr kernels::IntegerRule kInterruptCountRule{1, 64};

struct CpuConfig {
  int interrupts = 1;             // inputs, kInterruptCountRule
  std::uint64_t memory_base = 0;  // address on the bus of the first byte of host_memory
};

// The host's processor, which runs one program (contract section 3, "Software"): the program takes no time of
// its own, each of its accesses to a register is a transaction of one word that does. Host memory is reached
// by DMI, which must not be revoked. One interrupt input that is asserted is enough (the shared INTA#).
//
// An access that is answered with an error throws into the program. An exception that leaves the program ends
// it, and is reported with SC_REPORT_ERROR (type /stereotlm/cpu).
class Cpu : public sc_core::sc_module, private HostBus {
 public:
  tlm_utils::simple_initiator_socket<Cpu> bus{"bus"};
  tlm_utils::simple_initiator_socket<Cpu> host_memory{"host_memory"};
  sc_core::sc_vector<InterruptIn> interrupts;

  // `program` outlives the processor. Throws std::invalid_argument if the number of interrupts breaks its
  // rule.
  Cpu(const sc_core::sc_module_name& name, const CpuConfig& config, Program& program);

  // Whether the program has returned, and when it does.
  bool finished() const { return finished_; }
  const sc_core::sc_event& finished_event() const { return finished_event_; }

 private:
  std::uint32_t read(std::uint64_t address) override;
  void write(std::uint64_t address, std::uint32_t value) override;
  void wait_for_interrupt() override;
  std::uint8_t* memory(std::uint64_t address, std::uint64_t bytes) override;
  void run();
  bool interrupted() const;
  void end_access(bool ok, const char* what, std::uint64_t address, const sc_core::sc_time& delay);

  CpuConfig config_;
  Program& program_;
  memory::WordAccess access_{bus};
  sc_core::sc_event_or_list interrupts_change_;
  bool accessed_ = true;  // since the last return from wait_for_interrupt
  bool finished_ = false;
  sc_core::sc_event finished_event_{"finished"};
};

}  // namespace stereotlm::host
