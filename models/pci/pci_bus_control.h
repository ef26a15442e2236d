#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/clock.h"
#include "models/pci/pci_config.h"
#include "models/pci/pci_slot.h"
#include "models/time_ps.h"

namespace stereotlm::pci {

// A burst on the PCI bus that has ended. Each time is that at which a clock of the bus begins.
struct EndedPciBurst {
  std::size_t master = 0;             // its slot
  std::optional<std::size_t> window;  // none: a master abort
  bool write = false;                 // true: a write; false: a read
  std::uint64_t address = 0;          // on the bus
  std::uint64_t words = 0;            // transferred words
  std::uint64_t request_ps = 0;       // the first clock that could have been granted to the master
  std::uint64_t address_ps = 0;       // time of the address clock
  std::uint64_t data_ps = 0;          // the clock after the address clock
  std::uint64_t end_ps = 0;           // time of the idle clock
};

// Receives the bursts of the PCI bus, for traces. Plain C++.
class PciBusObserver {
 public:
  virtual ~PciBusObserver() = default;
  // Called at the end of each burst.
  virtual void pci_burst_ended(const EndedPciBurst& burst) = 0;
};

// The arbitration, the timing and the counters of PciBus, whose comment describes them. Plain C++.
class PciBusControl {
 public:
  // Counts of a master since time 0.
  struct MasterStats {
    std::string name;                // of its slot, in the configuration
    std::uint64_t transactions = 0;  // bursts, counted at their end
    std::uint64_t words = 0;         // words transferred
    std::uint64_t wait_clocks = 0;   // from the first clock at or after a request to its address clock
    std::uint64_t retries = 0;       // bursts that the target disconnected before the first word
    std::uint64_t aborts = 0;        // bursts that ended with kMasterAbort or kTargetError
  };
  // What the bus has counted since time 0.
  struct Stats {
    std::uint64_t clocks = 0;          // whole clocks since time 0
    std::uint64_t busy_clocks = 0;     // address, wait and data clocks among them
    std::vector<MasterStats> masters;  // [slot]
  };

  // `config` must have no problems.
  explicit PciBusControl(const PciBusConfig& config);
  PciBusControl(const PciBusControl&) = delete;
  PciBusControl& operator=(const PciBusControl&) = delete;

  // The target of each window outlives the bus. To be called before the first burst.
  void bind(std::size_t window, PciTarget& target) { windows_[window].target = &target; }
  // `observer` outlives the bus.
  void observe(PciBusObserver& observer) { observer_ = &observer; }
  PciSlot& slot(std::size_t master) { return slots_[master]; }
  const PciSlot& slot(std::size_t master) const { return slots_[master]; }
  const Clock& clock() const { return clock_; }

  // The time of the next step() or decide().
  std::uint64_t next_ps() const { return next_ps_; }
  // Whether decide() is next, which grants the bus after all other effects of this time. Else step() is.
  bool decides_next() const { return state_ == State::kFree; }
  void step(std::uint64_t now_ps);
  void decide(std::uint64_t now_ps);  // throws std::logic_error for an address that is no multiple of 4
  // Whether the next step() calls a target with a write. If not, it calls none.
  bool writes_next() const;
  // The target answers the access that it has not answered yet.
  void answer(std::uint64_t now_ps, const PciAnswer& answer);

  // Counts up to `now_ps`.
  Stats stats(std::uint64_t now_ps) const;

 private:
  class Slot final : public PciSlot {
   public:
    Slot(PciBusControl& bus, std::size_t master) : bus_(bus), master_(master) {}
    void request(PciMasterIf& master, std::uint64_t from_ps) override {
      bus_.request(master_, master, from_ps);
    }
    BurstResult transferred(std::uint64_t now_ps) const override { return bus_.transferred(master_, now_ps); }
    const Clock& clock() const override { return bus_.clock_; }

   private:
    PciBusControl& bus_;
    std::size_t master_;
  };
  struct Window {
    PciWindow config;
    PciTarget* target = nullptr;
  };
  struct Request {
    PciMasterIf* from = nullptr;
    std::uint64_t clock = kNever;  // the first clock that can be granted; kNever: no request
  };
  enum class State : std::uint8_t {
    kFree,      // decide() is due when a request can be granted
    kOccupied,  // a master or a target is being called; requests are recorded
    kWords,     // step() is due at the end of the last data clock; a request may cut the words
    kEnding,    // step() is due at the end of the burst, which no request changes
  };
  struct Running {
    std::size_t master = 0;
    PciBurst burst;
    Window* window = nullptr;  // null: none has this address
    std::size_t accepted = 0;  // words that the target takes of a write; all words of a read
    std::uint64_t request_clock = 0;
    std::uint64_t address_clock = 0;
    std::uint64_t end_clock = 0;  // the idle clock, as planned so far
    BurstResult result;
  };

  // These take requests.
  void request(std::size_t master, PciMasterIf& from, std::uint64_t from_ps);
  void await_request();
  // The earliest clock of the requests, without that of this master. kNever: there is none.
  std::uint64_t earliest_request(std::size_t without) const;

  // These step through a burst.
  void begin(std::uint64_t now_ps, std::size_t master, const PciBurst& burst, std::uint64_t request_clock,
             std::uint64_t clock);
  void begin_words(std::uint64_t first_clock);
  void cut_words();
  void end_words_at(std::uint64_t clock);
  void end_words(std::uint64_t now_ps);
  void end_at(std::uint64_t clock, const BurstResult& result);
  void end(std::uint64_t now_ps);
  // Without an observer it costs nothing beside the branch around it.
  [[gnu::cold, gnu::noinline]] void report() const;

  // These access the target.
  Window* window_of(const PciBurst& burst);
  void access(std::uint64_t now_ps, std::vector<std::uint32_t>& words, std::size_t count);
  std::uint64_t access_clock() const;
  void end_access(std::uint64_t now_ps, bool ok, std::uint64_t clock);

  void count(std::size_t master, const BurstResult& result);
  BurstResult transferred(std::size_t master, std::uint64_t now_ps) const;
  // The number of clocks that have ended by now.
  std::uint64_t whole_clocks(std::uint64_t now_ps) const { return clock_.edge_at_or_after(now_ps + 1) - 1; }

  Clock clock_;
  std::uint64_t latency_timer_clocks_;
  std::size_t words_per_clock_;
  std::vector<Window> windows_;
  std::vector<Slot> slots_;        // [master]
  std::vector<Request> requests_;  // [master]
  std::size_t last_granted_;       // index of the master that was granted last
  State state_ = State::kFree;
  std::uint64_t next_ps_ = kNever;
  std::uint64_t free_clock_ = 0;           // the first clock that can be an address clock
  std::uint64_t last_ps_ = kNever;         // time of the clock before it
  std::uint64_t decision_clock_ = kNever;  // in kFree: the clock that decide() is to grant
  bool burst_runs_ = false;
  Running running_;
  std::vector<std::uint32_t> read_words_;
  std::uint64_t busy_clocks_ = 0;  // clocks of the bursts that have ended
  std::vector<MasterStats> master_stats_;
  PciBusObserver* observer_ = nullptr;
};

}  // namespace stereotlm::pci
