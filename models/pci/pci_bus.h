#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/clock.h"
#include "models/pci/pci_config.h"
#include "models/pci/pci_slot.h"

namespace stereotlm::pci {

using PciStopPort = sc_core::sc_port<PciStopIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND>;

// A 32-bit PCI bus (contract section 3). A burst is an address clock, the target's wait clocks, one clock a
// word and an idle clock; the next address clock can be the one after that, since arbitration is hidden
// behind the burst. It costs a few waits of one process, however long it is.
//
// Arbitration is round robin, from the slot after the last one granted (at first from slot 0), among the
// requests made at or before the beginning of the clock: it is decided 1 ps later, so that every request made
// at the very time of the edge counts. A grant that its master gives back unused costs no clock; the next one
// is asked in the same. If another master waits, the burst ends with the first word transferred in clock
// latency_timer_clocks or later, the address clock being clock 0; a request in the middle counts from the
// first clock that begins at or after it.
//
// Targets see addresses relative to their window.
//
// A write reaches its target by one b_transport at the end of the last data clock, with the words
// transferred. At the address clock `stops` says how many words the target can take; with 0 (a retry) the
// burst ends with its address clock. Time that b_transport takes keeps the bus waiting behind the last word,
// and end_burst() with it.
//
// A read is one b_transport in its address clock, of all words, with the end of that clock as its delay. The
// first word comes after the window's wait clocks, and not before the first clock that begins at or after
// the time that b_transport returns with (by waiting, or by its delay). The master's words are filled as far
// as transferred.
//
// A response other than OK ends the burst with kTargetError: a write after its words, a read (target abort)
// with the clock that the first word would have had. A burst that lies in no window, or not wholly inside
// one, is a master abort after the address clock and 4 clocks without DEVSEL# (common knowledge, no source at
// hand).
//
// An address that is not a multiple of 4, and a target that can take more words than asked, are reported with
// SC_REPORT_ERROR (type /stereotlm/pci_bus).
class PciBus : public sc_core::sc_module {
 public:
  struct MasterStats {
    std::string name;
    std::uint64_t transactions = 0;  // address clocks
    std::uint64_t words = 0;         // transferred
    std::uint64_t wait_clocks = 0;   // from the first clock at or after a request to its address clock
    std::uint64_t retries = 0;       // disconnected with no word transferred
    std::uint64_t aborts = 0;        // master aborts and errors of targets
  };
  struct Stats {
    std::uint64_t clocks = 0;          // whole clocks since time 0
    std::uint64_t busy_clocks = 0;     // of these: address, wait and data clocks
    std::vector<MasterStats> masters;  // [slot]; a burst counts when it has ended
  };

  sc_core::sc_vector<PciSlotExport> slots;  // [master]; one that nobody uses may stay unbound
  sc_core::sc_vector<tlm_utils::simple_initiator_socket<PciBus>> targets;  // [window]
  sc_core::sc_vector<PciStopPort> stops;  // [window]; unbound: the target takes bursts of any length

  // Throws std::invalid_argument if the configuration has problems.
  PciBus(const sc_core::sc_module_name& name, const PciBusConfig& config);

  const Clock& clock() const { return clock_; }
  // Up to now.
  Stats stats() const;

 private:
  static constexpr std::uint64_t kNever = UINT64_MAX;

  class Slot : public PciSlotIf {
   public:
    explicit Slot(PciBus& bus) : bus_(bus) {}
    void request(PciMasterIf& master) override;
    const Clock& clock() const override { return bus_.clock_; }

    PciMasterIf* master = nullptr;
    std::uint64_t request_ps = kNever;  // of the request that waits

   private:
    PciBus& bus_;
  };
  // A burst that has the bus.
  struct Running {
    std::size_t master;
    PciBurst burst;
    std::uint64_t address_clock;
  };
  struct Outcome {
    BurstResult result;
    std::uint64_t end_clock;  // the idle clock
  };

  void run();
  std::uint64_t arbitrate(std::uint64_t clock);
  Outcome carry_out(const Running& running);
  Outcome write(const Running& running, std::size_t window);
  Outcome read(const Running& running, std::size_t window);
  std::size_t writable_words(const Running& running, std::size_t window);
  // Waits for the end of the data clocks, and returns the clock behind them.
  std::uint64_t transfer_words(const Running& running, std::uint64_t first_data_clock, std::size_t words);
  bool transport(tlm::tlm_command command, const Running& running, std::size_t window,
                 std::vector<std::uint32_t>& words, std::size_t count, sc_core::sc_time& delay);
  void count(std::size_t master, const BurstResult& result);
  std::optional<std::size_t> window_of(const PciBurst& burst) const;
  std::uint64_t offset(const PciBurst& burst, std::size_t window) const {
    return burst.address - config_.windows[window].base;
  }
  std::uint64_t earliest_request_ps(const Slot* except = nullptr) const;
  void wait_until(std::uint64_t time_ps);

  PciBusConfig config_;
  Clock clock_;
  std::deque<Slot> slots_;
  std::size_t last_granted_;
  sc_core::sc_event requested_{"requested"};
  tlm::tlm_generic_payload access_;
  std::vector<std::uint32_t> read_words_;
  std::optional<std::uint64_t> address_clock_;  // of the burst that runs
  std::uint64_t busy_clocks_ = 0;               // of those that have ended
  std::vector<MasterStats> master_stats_;
};

}  // namespace stereotlm::pci
