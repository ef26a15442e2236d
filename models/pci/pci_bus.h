#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/clock.h"
#include "models/decision_point.h"
#include "models/pci/pci_bus_control.h"
#include "models/pci/pci_config.h"
#include "models/pci/pci_slot_if.h"
#include "models/step_event.h"

namespace stereotlm::pci {

using PciStopPort = sc_core::sc_port<PciStopIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND>;  // of a target

// A PCI bus of 32 or 64 bits (contract sections 3 and 7.10). Targets see addresses relative to their window.
//
// Burst: an address clock, the target's wait clocks, one data clock per word (64 bits: per two words) and an
// idle clock. The next address clock can follow immediately, because arbitration is hidden behind the burst.
// A burst of any length costs two events: its grant and its end. If the request of another master cuts the
// burst, the second event moves.
//
// Arbitration: round robin, from the slot after the last one granted, at first from slot 0. It considers the
// requests made at or before the beginning of the clock, and decides when nothing else is pending at that
// time (DecisionPoint): requests and target registers count as they stand after everything that happens at
// the clock's edge. If a master returns its grant unused, the next request is granted in the same clock.
//
// Latency timer: the address clock is clock 0. If another master waits, the burst ends with the first data
// clock that is clock latency_timer_clocks or later. A request made during the burst counts from the first
// clock that begins at or after it.
//
// Write: the target receives one b_transport at the end of the last data clock, with the words transferred.
// At the address clock, `stops` returns how many words the target can take; with 0 (a retry) the burst ends
// with its address clock. Time that b_transport takes keeps the bus occupied and delays end_burst().
//
// Read: the target receives one b_transport for all words in the address clock, with the end of that clock
// as its delay. The first word is transferred after the window's wait clocks, and not before the first clock
// that begins at or after the time at which b_transport returns, its delay included. The master receives the
// words that have been transferred.
//
// Errors: a response other than OK ends the burst with kTargetError: a write after its words, a read (target
// abort) with the clock of its first word. A burst that is not inside one window ends with kMasterAbort after
// the address clock and 4 clocks without DEVSEL# (common knowledge, no source at hand). SC_REPORT_ERROR (type
// /stereotlm/pci_bus) reports: an address that is not a multiple of 4; a target that can take more words than
// asked.
class PciBus : public sc_core::sc_module {
 public:
  using MasterStats = PciBusControl::MasterStats;  // of one slot
  using Stats = PciBusControl::Stats;              // of all slots

  sc_core::sc_vector<PciSlotExport> slots;  // [master]; an unused slot may stay unbound
  sc_core::sc_vector<tlm_utils::simple_initiator_socket<PciBus>> targets;  // [window]
  sc_core::sc_vector<PciStopPort> stops;  // [window]; unbound: the target takes bursts of any length

  // Throws std::invalid_argument if the configuration has problems.
  PciBus(const sc_core::sc_module_name& name, const PciBusConfig& config);

  PciBusControl& control() { return control_; }            // the rules behind the sockets
  const Clock& clock() const { return control_.clock(); }  // the clock of the bus
  // Counts up to the current time.
  Stats stats() const { return control_.stats(kernel_time::now_ps()); }

 private:
  // A slot of the control, for the master in it.
  class Slot : public PciSlotIf {
   public:
    Slot(PciBus& bus, std::size_t master) : bus_(bus), slot_(bus.control_.slot(master)) {}
    using PciSlotIf::request;
    void request(PciMasterIf& master, std::uint64_t from_ps) override {
      slot_.request(master, from_ps);
      bus_.await_step();
    }
    BurstResult transferred(std::uint64_t now_ps) const override { return slot_.transferred(now_ps); }
    const Clock& clock() const override { return slot_.clock(); }

   private:
    PciBus& bus_;
    PciSlot& slot_;
  };
  // A target, between the control and the sockets of its window.
  class Target : public PciTarget {
   public:
    Target(PciBus& bus, std::size_t window) : bus_(bus), window_(window) {}
    std::size_t writable_words(std::uint64_t now_ps, std::uint64_t address, std::size_t words) override;
    PciAnswer access(std::uint64_t /*now_ps*/, const PciAccess& access, std::uint64_t at_ps) override {
      return bus_.access(window_, access, at_ps);
    }

   private:
    PciBus& bus_;
    std::size_t window_;
  };

  void await_step();
  void step();
  void decide();
  void run_transports();
  PciAnswer access(std::size_t window, const PciAccess& access, std::uint64_t at_ps);
  PciAnswer transport();

  PciBusControl control_;
  std::deque<Slot> slots_;
  std::deque<Target> targets_;
  DecisionPoint decision_{"decision", [this] { decide(); }};
  bool decides_ = false;  // the decision has been requested
  StepEvent step_{"next_step"};
  StepEvent transport_{"next_transport"};  // of a step or an access that calls b_transport
  bool in_thread_ = false;                 // that step is being taken
  std::size_t window_ = 0;                 // of access_
  std::uint64_t access_ps_ = 0;
  tlm::tlm_generic_payload access_;
  bool access_is_due_ = false;
};

}  // namespace stereotlm::pci
