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
#include "models/pci/decision_point.h"
#include "models/pci/direct_memories.h"
#include "models/pci/pci_config.h"
#include "models/pci/pci_slot_if.h"

namespace stereotlm::pci {

using PciStopPort = sc_core::sc_port<PciStopIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND>;

// A 32-bit PCI bus (contract section 3). Targets see addresses relative to their window.
//
// Burst: an address clock, the target's wait clocks, one clock per word and an idle clock. The next address
// clock can follow immediately, because arbitration is hidden behind the burst. A burst of any length costs
// two events: its grant and its end. A request that cuts the burst moves the second one.
//
// Arbitration: round robin, from the slot after the last one granted, at first from slot 0. It considers the
// requests made at or before the beginning of the clock, and decides when nothing else is pending at that
// time (DecisionPoint): requests and target registers count as they stand after everything that happens at
// the clock's edge. If a master returns its grant unused, the next request is granted in the same clock.
//
// Latency timer: the address clock is clock 0. If another master waits, the burst ends with the first word
// transferred in clock latency_timer_clocks or later. A request made during the burst counts from the first
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
// A memory that grants DMI without latency is accessed directly, at the same times.
//
// Errors: a response other than OK ends the burst with kTargetError: a write after its words, a read (target
// abort) with the clock of its first word. A burst that is not inside one window ends with kMasterAbort after
// the address clock and 4 clocks without DEVSEL# (common knowledge, no source at hand). SC_REPORT_ERROR (type
// /stereotlm/pci_bus) reports: an address that is not a multiple of 4; a target that can take more words than
// asked.
class PciBus : public sc_core::sc_module {
 public:
  struct MasterStats {
    std::string name;
    std::uint64_t transactions = 0;  // bursts, counted at their end
    std::uint64_t words = 0;         // words transferred
    std::uint64_t wait_clocks = 0;   // from the first clock at or after a request to its address clock
    std::uint64_t retries = 0;       // bursts that the target disconnected before the first word
    std::uint64_t aborts = 0;        // bursts that ended with kMasterAbort or kTargetError
  };
  struct Stats {
    std::uint64_t clocks = 0;          // whole clocks since time 0
    std::uint64_t busy_clocks = 0;     // address, wait and data clocks among them
    std::vector<MasterStats> masters;  // [slot]
  };

  sc_core::sc_vector<PciSlotExport> slots;  // [master]; an unused slot may stay unbound
  sc_core::sc_vector<tlm_utils::simple_initiator_socket<PciBus>> targets;  // [window]
  sc_core::sc_vector<PciStopPort> stops;  // [window]; unbound: the target takes bursts of any length

  // Throws std::invalid_argument if the configuration has problems.
  PciBus(const sc_core::sc_module_name& name, const PciBusConfig& config);

  const Clock& clock() const { return clock_; }
  // Counts up to the current time.
  Stats stats() const;

 private:
  static constexpr std::uint64_t kNever = UINT64_MAX;

  class Slot : public PciSlotIf {
   public:
    Slot(PciBus& bus, std::size_t master) : bus_(bus), master_(master) {}
    using PciSlotIf::request;
    void request(PciMasterIf& master, std::uint64_t from_ps) override {
      bus_.request(master_, master, from_ps);
    }
    BurstResult transferred(std::uint64_t now_ps) const override { return bus_.transferred(master_, now_ps); }
    const Clock& clock() const override { return bus_.clock_; }

   private:
    PciBus& bus_;
    std::size_t master_;
  };
  struct Request {
    PciMasterIf* from = nullptr;
    std::uint64_t clock = kNever;  // the first clock that can be granted; kNever: no request
  };
  enum class State : std::uint8_t {
    kFree,      // step_ is due when a request can be granted
    kOccupied,  // a master or a target is being called; requests are recorded
    kWords,     // step_ or transport_ is due at the end of the last data clock; a request may cut the words
    kEnding,    // step_ is due at the end of the burst, which no request changes
  };
  struct Running {
    std::size_t master = 0;
    PciBurst burst;
    std::size_t window = 0;
    std::size_t accepted = 0;  // words that the target takes of a write; all words of a read
    std::uint64_t address_clock = 0;
    std::uint64_t end_clock = 0;  // the idle clock, as planned so far
    bool transported = false;     // transport_, not step_, is due at the end of the last data clock
    BurstResult result;
  };

  // These take requests.
  void request(std::size_t master, PciMasterIf& from, std::uint64_t from_ps);
  void await_request();
  std::uint64_t earliest_request(std::size_t except) const;

  // These step through a burst.
  void step();
  void arbitrate();
  void begin(std::size_t master, const PciBurst& burst);
  void begin_words(std::uint64_t first_clock, std::size_t words);
  void cut_words();
  void end_words_at(std::uint64_t clock);
  void end_words();
  void end_at(std::uint64_t clock, const BurstResult& result);
  void end();
  void step_at(std::uint64_t time_ps);

  // These access the target.
  std::optional<std::size_t> window_of(const PciBurst& burst) const;
  std::size_t writable_words() const;
  void access(std::vector<std::uint32_t>& words, std::size_t count);
  std::uint64_t access_clock() const;
  void run_transports();
  void transport();
  void end_access(bool ok, std::uint64_t clock);
  void forget_memories(sc_dt::uint64 /*first*/, sc_dt::uint64 /*last*/) { memories_.forget(); }

  void count(std::size_t master, const BurstResult& result);
  BurstResult transferred(std::size_t master, std::uint64_t now_ps) const;
  std::uint64_t whole_clocks(std::uint64_t now_ps) const;

  PciBusConfig config_;
  Clock clock_;
  std::deque<Slot> slots_;
  std::vector<Request> requests_;  // [master]
  std::size_t last_granted_;       // index of the master that was granted last
  DecisionPoint arbitration_{"arbitration", [this] { arbitrate(); }};
  State state_ = State::kFree;
  std::uint64_t free_clock_ = 0;           // the first clock that can be an address clock
  std::uint64_t decision_clock_ = kNever;  // in kFree: the clock that arbitrate() is to grant
  Running running_;
  sc_core::sc_event step_{"next_step"};
  sc_core::sc_event transport_{"next_transport"};
  bool transport_is_due_ = false;
  tlm::tlm_generic_payload access_;
  DirectMemories memories_;
  std::vector<std::uint32_t> read_words_;
  std::optional<std::uint64_t> address_clock_;  // address clock of the running burst; none: no burst runs
  std::uint64_t busy_clocks_ = 0;               // clocks of the bursts that have ended
  std::vector<MasterStats> master_stats_;
};

}  // namespace stereotlm::pci
