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
// behind the burst. It costs two events, however long it is: where it is granted, and where it ends. A
// request that cuts it moves its end.
//
// Arbitration is round robin, from the slot after the last one granted (at first from slot 0), among the
// requests made at or before the beginning of the clock. It is decided when nothing else is pending at that
// time, so that whatever happens at the very time of the edge counts: requests, and what the target's registers
// hold. A grant that its master gives back unused costs no clock; the next one is asked in the same. If another master waits, the burst ends with the first word transferred in clock
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
// A memory that allows DMI, and whose DMI takes no time, is accessed by it, at these times.
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
    Slot(PciBus& bus, std::size_t master) : bus_(bus), master_(master) {}
    using PciSlotIf::request;
    void request(PciMasterIf& master, std::uint64_t from_ps) override {
      bus_.request(master_, master, from_ps);
    }
    BurstResult transferred() const override { return bus_.transferred(master_); }
    const Clock& clock() const override { return bus_.clock_; }

   private:
    PciBus& bus_;
    std::size_t master_;
  };
  // Of one master.
  struct Request {
    PciMasterIf* from = nullptr;
    std::uint64_t clock = kNever;  // the first that it can have, while it waits
  };
  enum class State : std::uint8_t {
    kFree,      // step_ comes when a request can be granted
    kOccupied,  // a master or a target is being asked: requests are noted
    kWords,     // step_ or transport_ comes when the words have been transferred; a request may cut them
    kEnding,    // step_ comes when the burst ends, whatever is requested
  };
  // The burst that has the bus.
  struct Running {
    std::size_t master = 0;
    PciBurst burst;
    std::size_t window = 0;
    std::size_t taken = 0;  // words that the target takes, or is read
    std::uint64_t address_clock = 0;
    std::uint64_t end_clock = 0;  // the idle clock, as far as known
    bool transported = false;     // its words end with transport_
    BurstResult result;
  };
  // What the target behind a window has granted.
  struct Memory {
    unsigned char* data = nullptr;  // of address `first`
    std::uint64_t first = 0;
    std::uint64_t last = 0;
  };

  // Requests.
  void request(std::size_t master, PciMasterIf& from, std::uint64_t from_ps);
  void await_request();
  std::uint64_t earliest_request(std::size_t except) const;

  // The steps of a burst.
  void step();
  void start_of_simulation() override;
  void decide_when_settled(PciBus& bus);
  void decide();
  void arbitrate();
  void begin(std::size_t master, const PciBurst& burst);
  void begin_words(std::uint64_t first_clock, std::size_t words);
  void cut_words();
  void end_words_at(std::uint64_t clock);
  void end_words();
  void end_at(std::uint64_t clock, const BurstResult& result);
  void end();

  // Its access to the target, in the clock that begins with it.
  void access(std::vector<std::uint32_t>& words, std::size_t count);
  std::uint64_t access_clock() const;
  bool access_memory();
  void run_transports();
  void transport();
  void learn_memory();
  void forget_memories(sc_dt::uint64 /*first*/, sc_dt::uint64 /*last*/) {
    memories_.assign(memories_.size(), {});
  }
  void answered(bool ok, std::uint64_t clock);

  BurstResult transferred(std::size_t master) const;
  std::uint64_t whole_clocks() const;  // since time 0
  std::size_t writable_words() const;
  void count(std::size_t master, const BurstResult& result);
  std::optional<std::size_t> window_of(const PciBurst& burst) const;
  void step_at(std::uint64_t time_ps);

  PciBusConfig config_;
  Clock clock_;
  std::deque<Slot> slots_;
  std::vector<Request> requests_;  // [master]
  std::size_t last_granted_;
  State state_ = State::kFree;
  std::uint64_t free_clock_ = 0;           // the first that can be an address clock
  std::uint64_t decision_clock_ = kNever;  // that step_ is to grant, in kFree
  // The bus whose process decides for all of a simulation: two that wait until nothing else is pending would
  // wait for each other.
  PciBus* decider_ = this;
  std::vector<PciBus*> undecided_;  // of the decider: the buses that it is to decide now
  sc_core::sc_event decision_{"decision"};
  Running running_;
  sc_core::sc_event step_{"next_step"};
  sc_core::sc_event transport_{"next_transport"};  // or the end of words that are transported
  bool transport_is_due_ = false;
  tlm::tlm_generic_payload access_;
  std::vector<Memory> memories_;  // [window]
  std::vector<std::uint32_t> read_words_;
  std::optional<std::uint64_t> address_clock_;  // of the burst that runs
  std::uint64_t busy_clocks_ = 0;               // of those that have ended
  std::vector<MasterStats> master_stats_;
};

}  // namespace stereotlm::pci
