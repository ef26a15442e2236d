#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/fpga/core_registers.h"
#include "models/refusals.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The register file of register_map.h: start strobe, status, bases and offsets of a frame, done interrupt.
// An access takes no time; there is no DMI and no debug transport. A start strobe takes effect at the
// annotated time of its access.
//
// | refused, without effect                                                        | response           |
// |--------------------------------------------------------------------------------|--------------------|
// | an address that is no register                                                 | address error      |
// | a length other than 4, or a streaming width below it                           | burst error        |
// | byte enables                                                                   | byte enable error  |
// | a read of a write-only register, a write of a read-only one, any other command | command error      |
class RegisterFile : public sc_core::sc_module, private CoreRegisters::Starter {
 public:
  // Register accesses since time 0.
  struct Stats {
    std::uint64_t reads = 0;   // allowed reads
    std::uint64_t writes = 0;  // allowed writes
    std::uint64_t errors = 0;  // refused accesses
  };

  // Two sockets of the same registers; either may stay unbound.
  tlm_utils::simple_target_socket_optional<RegisterFile> registers{"registers"};
  tlm_utils::simple_target_socket_optional<RegisterFile> local_bus{"local_bus"};
  sc_core::sc_out<bool> done{"done"};  // the interrupt: high from the end of a frame until it is acknowledged
  StreamOut<FrameStart> start_out{"start_out"};

  explicit RegisterFile(const sc_core::sc_module_name& name);  // all registers are 0

  // To be called by the receiver of start_out to refuse the strobe.
  void refuse_start() { control_.refuse_start(); }
  // See CoreRegisters.
  void finish_frame(std::uint64_t frame_cycles, bool error);
  const Stats& stats() const { return stats_; }

 private:
  void transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  void start_frame(const FrameStart& start) override { start_out->push(start); }
  void drive_done();

  CoreRegisters control_{*this};
  sc_core::sc_event done_changed_{"done_changed"};
  Stats stats_;
  Refusals refusals_{*this};
};

}  // namespace stereotlm::fpga
