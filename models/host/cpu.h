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

inline constexpr kernels::IntegerRule kInterruptCountRule{1, 64};  // of CpuConfig::interrupts

// The configuration of a Cpu.
struct CpuConfig {
  int interrupts = 1;             // interrupt inputs, kInterruptCountRule
  std::uint64_t memory_base = 0;  // bus address of the first byte of host_memory
};

// The host's processor, which runs one program (contract section 3, "Software"). The program itself takes no
// time. Each of its register accesses is a transaction of one word, and takes the time of that transaction.
// The program reaches host memory by DMI, which the memory must not revoke. An interrupt is pending while at
// least one interrupt input is asserted (the shared INTA#).
//
// If an access has an error response, BusError is thrown in the program. If an exception leaves the program,
// the program ends, and the exception is reported with SC_REPORT_ERROR (type /stereotlm/cpu).
class Cpu : public sc_core::sc_module, private HostBus {
 public:
  tlm_utils::simple_initiator_socket<Cpu> bus{"bus"};                  // for register accesses
  tlm_utils::simple_initiator_socket<Cpu> host_memory{"host_memory"};  // for DMI
  sc_core::sc_vector<InterruptIn> interrupts;                          // INTA# of each device

  // `program` outlives the processor. Throws std::invalid_argument if the number of interrupt inputs breaks
  // kInterruptCountRule.
  Cpu(const sc_core::sc_module_name& name, const CpuConfig& config, Program& program);

  // Whether the program has returned, and an event for its return.
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
  bool accessed_ = true;  // a register was accessed since wait_for_interrupt() returned
  bool finished_ = false;
  sc_core::sc_event finished_event_{"finished"};
};

}  // namespace stereotlm::host
