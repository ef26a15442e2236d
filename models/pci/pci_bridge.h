#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <cstddef>
#include <cstdint>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/access_queue.h"
#include "models/interrupt.h"
#include "models/pci/bridge_control.h"
#include "models/pci/pci_config.h"
#include "models/pci/pci_slot_if.h"
#include "models/refusals.h"
#include "models/step_event.h"

namespace stereotlm::pci {

// The bridge between the PCI bus and the local bus of the FPGA board (contract section 3, "Bridge"): the
// sockets of a BridgeControl. Its registers and descriptors are in bridge_registers.h.
//
// - The bridge takes as many words of a posted write as it has free places at the address clock (`stop`).
// - A read of the slave window blocks until its words have arrived. Reads of several processes are served in
//   the order in which they arrive. If a process is killed or reset while it waits, its access is lost, and
//   reported (AccessQueue); a read that is under way runs to its end, before the next one.
//
// These accesses have an error response and no effect: a register access that is not one aligned word or has
// the wrong direction, a slave access outside the window, and a posted write of more words than there are
// free places.
class PciBridge : public sc_core::sc_module,
                  private PciStopIf,
                  private InterruptIf,
                  private LocalBusIf,
                  private BridgeControl::Host {
 public:
  using Stats = BridgeControl::Stats;  // counts since time 0

  tlm_utils::simple_target_socket<PciBridge> slave{"slave"};  // slave window: apertures and core registers
  tlm_utils::simple_target_socket<PciBridge> registers{"registers"};  // register window
  sc_core::sc_export<PciStopIf> stop{"stop"};                         // STOP# of the slave window
  PciMasterPort pci{"pci", [this] { await_step(); }};                 // bus mastering of the DMA channels
  tlm_utils::simple_initiator_socket<PciBridge> local{"local"};       // to fpga/local_bus.h
  sc_core::sc_in<bool> doorbell{"doorbell"};  // from the FPGA; its rising edge raises kDoorbell
  InterruptOut interrupt{"interrupt"};        // INTA#

  // Throws std::invalid_argument if the configuration has problems.
  PciBridge(const sc_core::sc_module_name& name, const PciBridgeConfig& config);

  BridgeControl& control() { return control_; }            // the rules behind the sockets
  const Stats& stats() const { return control_.stats(); }  // counts up to the present time

 private:
  // These serve the slave window and the register window.
  std::size_t writable_words(std::uint64_t address, std::size_t words) const override;
  void access_slave(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);
  tlm::tlm_response_status write_slave(const tlm::tlm_generic_payload& access);
  tlm::tlm_response_status read_slave(const tlm::tlm_generic_payload& access);
  void slave_read_ended(std::uint64_t now_ps, bool ok) override;
  void access_registers(tlm::tlm_generic_payload& access, sc_core::sc_time& delay);

  // These are the interrupt line and the doorbell.
  bool is_asserted() const override { return control_.interrupts(); }
  const sc_core::sc_event& changed_event() const override { return interrupt_changed_; }
  void interrupt_changed(std::uint64_t /*now_ps*/) override {
    interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
  }
  void ring();

  // These are the two ends of the local bus.
  bool begin_burst(std::uint64_t now_ps, const LocalBurst& burst) override;
  tlm::tlm_sync_enum respond(tlm::tlm_generic_payload& burst, tlm::tlm_phase& phase, sc_core::sc_time& delay);
  void end_local_burst(const sc_core::sc_time& delay);

  void step();
  void await_step() { step_.set(control_.next_ps()); }

  class Manager : public tlm::tlm_mm_interface {
    void free(tlm::tlm_generic_payload* /*payload*/) override {}
  };

  BridgeControl control_;
  Refusals refusals_{*this};
  StepEvent step_{"next_step"};
  sc_core::sc_event interrupt_changed_{"interrupt_changed"};
  AccessQueue slave_reads_{slave};
  AccessQueue slave_writes_{slave};  // which wait for their time alone
  bool reads_ = false;               // a read of the slave window is under way
  bool read_ok_ = false;
  std::vector<unsigned char> read_bytes_;
  sc_core::sc_event read_ended_{"read_ended"};
  Manager manager_;
  tlm::tlm_generic_payload burst_{&manager_};  // on the local bus
};

}  // namespace stereotlm::pci
