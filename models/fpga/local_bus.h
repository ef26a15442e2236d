#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>
#include <systemc>
#include <tlm>

#include "models/fpga/local_bus_control.h"
#include "models/kernel_time.h"
#include "models/memory/word_access.h"
#include "models/refusals.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The FPGA's end of the bridge's local bus (contract section 3; the state machine of Alpha Data's examples).
// A burst is one transaction of consecutive words in one bank, or of registers, by nb_transport. One burst
// is under way at a time. Its timing is that of LocalBusControl:
//
// - BEGIN_REQ stands for the address clock: the first clock that begins at or after the annotated time.
// - BEGIN_RESP stands for the end of the idle clock after the last word, when the bus is free. The next
//   BEGIN_REQ comes after END_RESP (or TLM_COMPLETED). Where the end of a burst is known at BEGIN_REQ, it is
//   answered with TLM_COMPLETED and the time until then.
//
// | refused at BEGIN_REQ                                                              | response           |
// |-----------------------------------------------------------------------------------|--------------------|
// | an address that is no multiple of 4, or of no bank or register                    | address error      |
// | a length that is no multiple of 4, a streaming width below it, a burst beyond the | burst error        |
// | 2^28 bytes of its bank's addresses                                                |                    |
// | byte enables                                                                      | byte enable error  |
// | neither read nor write                                                            | command error      |
// | no memory manager                                                                 | generic error      |
//
// If a bank or register refuses a word, the burst has the response of the first such word; the other words
// are transferred. Debug transport reaches banks without a burst. There is no DMI, and b_transport is
// refused.
//
// The words of the banks need no process here: the core's process grants them.
class LocalBus : public sc_core::sc_module,
                 private tlm::tlm_fw_transport_if<>,
                 private LocalBusMasterIf,
                 private LocalBusControl::Core {
 public:
  using Stats = LocalBusControl::Stats;  // counts since time 0

  tlm::tlm_target_socket<32> bus{"bus"};                                // from the bridge
  tlm_utils::simple_initiator_socket<LocalBus> memory{"memory"};        // to the banks, through the crossbar
  tlm_utils::simple_initiator_socket<LocalBus> registers{"registers"};  // to the registers of the core
  // Pushes a route before the first word of a burst to a bank, and after its last word.
  StreamOut<HostRoute> route_out{"route_out"};

  // Throws std::invalid_argument if the clock or the number of banks is out of range.
  LocalBus(const sc_core::sc_module_name& name, const LocalBusConfig& config, std::size_t banks);

  LocalBusControl& control() { return control_; }              // the timing behind the sockets
  const LocalBusControl& control() const { return control_; }  // the timing behind the sockets
  // Notified when the first word of a burst begins to request.
  const sc_core::sc_event& request_event() const { return request_event_; }
  // Counts up to the current time.
  Stats stats() const { return control_.stats(kernel_time::now_ps()); }

 private:
  void b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) override;
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  unsigned transport_dbg(tlm::tlm_generic_payload& access) override;
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& /*access*/, tlm::tlm_dmi& dmi) override {
    dmi.allow_read_write();  // is refused, for all addresses
    return false;
  }

  tlm::tlm_response_status check(const tlm::tlm_generic_payload& access) const;
  void begin(tlm::tlm_generic_payload& access, const sc_core::sc_time& delay);
  void run_registers();
  void await_register();

  void route(const HostRoute& route) override { route_out->push(route); }
  bool access_bank(std::uint64_t at_ps, bool write, std::uint64_t address, std::uint32_t& word) override;
  bool access_register(std::uint64_t now_ps, bool write, std::uint64_t address, std::uint32_t& word) override;
  bool transfer(memory::WordAccess& through, bool write, std::uint64_t address, std::uint32_t& word,
                sc_core::sc_time delay);
  void end_burst_at(std::uint64_t end_ps, bool ok) override;

  LocalBusControl control_;
  Refusals refusals_{*this};
  memory::WordAccess memory_access_{memory};
  memory::WordAccess register_access_{registers};
  tlm::tlm_generic_payload* burst_ = nullptr;  // the burst under way, until END_RESP
  bool responding_ = false;                    // between BEGIN_RESP and END_RESP
  bool is_beginning_ = false;                  // in nb_transport_fw
  sc_core::sc_time end_delay_;                 // of a burst that has ended there
  tlm::tlm_response_status status_ = tlm::TLM_OK_RESPONSE;
  sc_core::sc_event request_event_{"request"};
  sc_core::sc_event register_event_{"register"};
};

}  // namespace stereotlm::fpga
