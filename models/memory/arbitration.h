#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/memory/bank_arbiter.h"
#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// Which port works on which bank, and what the banks' arbiters grant them in a cycle (contract section 2).
// Plain C++, no SystemC: the crossbar is built around it.
class Arbitration {
 public:
  Arbitration(const ArbiterConfig& arbiter, const std::vector<SsramBankConfig>& banks);

  // Requests of this port go to this bank, in this direction, from the next arbitrate() on. The bank must
  // exist.
  void route(Port port, std::size_t bank, bool write);
  // The port has nothing to request any more.
  void unroute(Port port);
  std::size_t bank_of(Port port) const { return routes_[index_of(port)].bank; }  // of its last route
  bool is_routed(Port port) const { return is_routed(index_of(port)); }
  // Whether a port other than this one is routed to the bank.
  bool is_used_beside(Port port, std::size_t bank) const;

  // One cycle: decides these requests, and returns the ports granted. Cycles must increase.
  PortMask arbitrate(std::uint64_t cycle, PortMask requests) {
    const auto granted = static_cast<PortMask>(requests & alone_);
    ++alone_cycles_[granted];
    if (requests == granted) return granted;
    return static_cast<PortMask>(granted |
                                 arbitrate_shared(cycle, static_cast<PortMask>(requests & ~alone_)));
  }
  // Whether whatever this port requests is granted at once, as long as no route changes.
  bool is_alone(Port port) const { return (alone_ & mask_of(port)) != 0; }
  // So many of the cycles granted to a port that is alone held no request, as it turns out. To be told before
  // a route changes or counting ends: then what is left of them moves the bank's place in the round robin.
  void take_back(Port port, std::uint64_t grants) { taken_back_[index_of(port)] += grants; }

  // One request of a port for a bank of which no routed port asks anything, in the given direction, and what
  // comes of it; it is counted later, by count_unrouted().
  BankArbiter::Outcome decide_unrouted(std::size_t bank, std::uint64_t cycle, Port port, bool write);
  void count_unrouted(std::size_t bank, std::uint64_t cycle, BankArbiter::Outcome outcome,
                      std::uint64_t cycles) {
    arbiters_[bank].count(cycle, outcome, cycles);
  }
  bool needs_turnaround(std::size_t bank) const { return arbiters_[bank].needs_turnaround(); }
  bool grants(std::size_t bank, BankArbiter::Outcome outcome) const {
    return arbiters_[bank].granted_in(outcome) != 0;
  }

  // All that arbitration from `cycle` on depends on as long as no route changes, one word a shared bank; the
  // others are 0.
  using State = std::array<std::uint32_t, kPortCount>;
  State state(std::uint64_t cycle) const;
  // What was decided in some cycles: of use as long as the same ports have the same routes.
  struct Decided {
    struct Shared {
      std::size_t bank;  // of the shared ones
      BankArbiter::Outcome outcome;
      std::uint64_t cycles;
    };
    struct Alone {
      std::size_t ports;  // granted, a mask
      std::uint64_t cycles;
    };
    std::vector<Shared> shared;
    std::vector<Alone> alone;
  };
  // From here on decisions are recorded, until take_recorded() or a change of routes, which drops them.
  void begin_recording();
  Decided take_recorded();
  // As if so many cycles had been arbitrated that lead to this state from `cycle` on: their decisions are
  // told by count_skipped().
  void skip_to(const State& state, std::uint64_t cycle, std::uint64_t cycles);
  void count_skipped(const Decided& decided, std::uint64_t times);

  // Only cycles first_cycle .. end_cycle - 1 are counted in the arbiters' statistics, which are complete when
  // counting has ended; their uncounted_accesses() always. Until then the grants of a port that is alone may
  // be taken back. Asking for the arbiters changes nothing.
  void begin_counting(std::uint64_t first_cycle);
  void end_counting(std::uint64_t end_cycle);
  const std::vector<BankArbiter>& arbiters() const {
    count_alone();
    return arbiters_;
  }

 private:
  struct Route {
    std::size_t bank = 0;
    bool write = false;
  };
  // A bank whose ports meet, or which needs turnaround.
  struct SharedBank {
    BankArbiter* arbiter = nullptr;
    PortMask ports = 0;
    std::vector<BankArbiter::Outcome> recorded;
  };

  bool is_routed(std::size_t port) const { return (routed_ >> port & 1U) != 0; }
  void share_banks();
  void count_alone() const;
  void settle();
  PortMask arbitrate_shared(std::uint64_t cycle, PortMask requests);

  mutable std::vector<BankArbiter> arbiters_;
  std::array<Route, kPortCount> routes_{};
  PortMask routed_ = 0;
  PortMask writes_ = 0;  // ports whose route writes
  // Ports alone on a bank without turnaround need no arbitration: the arbiter hears of their grants later, at
  // the latest when somebody asks it.
  PortMask alone_ = 0;
  using AloneCycles = std::array<std::uint64_t, std::size_t{1} << kPortCount>;  // [ports granted in this way]
  mutable AloneCycles alone_cycles_{};
  mutable AloneCycles alone_before_recording_{};                // only the difference to alone_cycles_ counts
  mutable std::array<std::uint64_t, kPortCount> taken_back_{};  // of the alone_cycles_
  mutable std::array<std::uint64_t, kPortCount> alone_grants_{};  // since settle(), without those taken back
  std::array<SharedBank, kPortCount> shared_banks_{};
  std::size_t shared_bank_count_ = 0;
  bool recording_ = false;
};

}  // namespace stereotlm::memory
