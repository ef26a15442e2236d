#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "models/memory/bank_arbiter.h"
#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// What a port did at a bank in some cycles.
struct BankUse {
  static constexpr std::size_t kAlone = SIZE_MAX;

  Port port = 0;
  std::size_t shared_bank = kAlone;  // number among the banks of Arbitration::shared(); kAlone: its own bank
  std::size_t by = kGranted;         // or the port that was granted instead, or another cause of a stall
  std::uint64_t cycles = 0;
};

// Arbitrates all banks (contract section 2): each port is routed to a bank, whose arbiter decides on its
// requests. The parts of a striped buffer lie in several banks (contract 8.2): its port is routed to all of
// them, and place() says which one it requests next. Used by Crossbar, by platform::CoreLoop without a
// crossbar, and by the core to skip cycles (fpga::FastForward, fpga::HostPort). Plain C++, no SystemC.
class Arbitration {
 public:
  // Throws std::invalid_argument if one of the configurations has problems.
  Arbitration(const ArbiterConfig& arbiter, const std::vector<SsramBankConfig>& banks);

  // The rule that a route of this port to this bank breaks: "port = 7: must be 0..5". Empty if both exist.
  std::string route_problem(Port port, std::size_t bank) const;
  // Routes the port to this bank from the next arbitrate() on. `write`: direction of all its requests. This
  // and the next two throw std::invalid_argument if the port is not one of the priority list, or the bank
  // does not exist.
  void route(Port port, std::size_t bank, bool write) {
    check_route(port, bank);
    route_stripe(port, bank_bit(bank), write);
  }
  // Routes the port to several banks. `banks`: bit b for bank b.
  void route_stripe(Port port, std::uint64_t banks, bool write);
  // Sets the bank that a port with several banks requests, which is one of them, and the word of a bank of
  // sdram. To be called before each arbitrate() with a request for another bank or another word.
  void place(Port port, std::size_t bank, std::uint32_t word) {
    words_[port] = word;
    if (routes_[port].bank != bank) move(port, bank);
  }
  // The ports to which place() applies: those with several banks, and those of banks of sdram.
  PortMask placed() const { return placed_; }
  // Whether a port is routed to a bank of sdram. False if all requests are granted.
  bool has_rows() const { return has_rows_; }
  // Removes the route of the port, which must not request from now on.
  void unroute(Port port);
  // Routes a port that changes its bank often. Its banks count as shared until the next route() or unroute().
  // So a visit of a shared bank changes nothing for the other ports: the words of append_state() keep their
  // layout, and a recording can go on.
  void visit(Port port, std::size_t bank, bool write);
  // Whether the bank is that of several ports or of a port with several banks, or does not grant at once, or
  // was visited.
  bool is_shared(std::size_t bank) const { return (shared_ >> bank & 1U) != 0; }
  // All such banks.
  std::uint64_t shared() const { return shared_; }
  std::size_t bank_of(Port port) const { return routes_[port].bank; }      // bank of its last route
  std::uint64_t banks_of(Port port) const { return routes_[port].banks; }  // all of its banks
  bool writes(Port port) const { return routes_[port].write; }             // direction of its last route
  bool is_routed(Port port) const { return has(routed_, port); }
  // Whether a port other than this one is routed to the bank.
  bool is_used_beside(Port port, std::size_t bank) const { return (ports_on(bank) & ~mask_of(port)) != 0; }

  // From now on each request is granted in its cycle, for the time that frames take without waits. The
  // statistics of the banks then have no meaning.
  void grant_all_requests() { grants_all_ = true; }

  // Decides the requests of one cycle, and returns the ports granted. `cycle` must increase from call to
  // call; a cycle that is left out has no request.
  PortMask arbitrate(std::uint64_t cycle, PortMask requests) {
    const auto granted = requests & alone_;
    for_each_port(granted, [this](Port port) { ++alone_grants_[port]; });
    if (requests == granted) return granted;
    return granted | arbitrate_shared(cycle, requests & ~alone_);
  }
  // The cause of a stall of this port in the cycle in which arbitrate() has returned `granted`: the port that
  // its bank has granted, or another cause.
  std::size_t cause_of(Port port, PortMask granted) const;

  // The arbiter of a bank, for requests of a port without route. No routed port may request the bank.
  BankArbiter& arbiter(std::size_t bank) { return arbiters_[bank]; }
  const BankArbiter& arbiter(std::size_t bank) const { return arbiters_[bank]; }

  // The state that determines all arbitration from `cycle` on, as long as no route changes. Without the rows
  // of sdram: BankArbiter::rows().
  void append_state(std::uint64_t cycle, StateWords& state) const;
  void set_state(std::uint64_t cycle, StateReader& state);

  // For FastForward, which steps a group of columns, records its counts, and skips the groups that repeat it.
  // No route may change between the two calls.
  void begin_recording() { recorded_ = counts(); }
  CountChanges take_recorded() const;
  // Adds the counts of skipped cycles.
  void count_skipped(const CountChanges& changes, std::uint64_t times);
  // What the ports did in the cycles of these changes, sorted by port, bank and cause.
  std::vector<BankUse> bank_uses(const CountChanges& changes) const;
  std::size_t bank_of(const BankUse& use) const {
    return use.shared_bank == BankUse::kAlone ? bank_of(use.port) : shared_banks_[use.shared_bank].bank;
  }

  // The statistics count cycles first_cycle .. end_cycle - 1 only. end_counting() adds the idle cycles.
  void begin_counting(std::uint64_t first_cycle);
  void end_counting(std::uint64_t end_cycle);
  // `end_cycle`: up to which rows and refreshes outside the counted cycles are counted.
  ArbiterStats stats(std::size_t bank, std::uint64_t end_cycle = 0) const;
  std::size_t banks() const { return arbiters_.size(); }

 private:
  struct Route {
    std::size_t bank = 0;  // that the port requests next
    bool write = false;
    std::uint64_t banks = 0;  // all of its banks
  };
  // See is_shared().
  struct SharedBank {
    std::size_t bank = 0;
    BankArbiter* arbiter = nullptr;
    PortMask ports = 0;               // those that request it next
    std::size_t cause = kTurnaround;  // of the last cycle with a request and without a grant
  };

  static constexpr std::uint64_t bank_bit(std::size_t bank) { return std::uint64_t{1} << bank; }
  void check_route(Port port, std::size_t bank) const;
  void forget_visits();
  void move(Port port, std::size_t bank);
  PortMask ports_on(std::size_t bank) const { return ports_on_[bank]; }
  void share_banks();
  void count_alone(PortMask ports);
  PortMask arbitrate_shared(std::uint64_t cycle, PortMask requests);
  // All counters that may change as long as no route does: the grants of the uncontended ports, then the
  // statistics of each shared bank.
  std::vector<std::uint64_t> counts() const;
  std::size_t counts_of_bank() const { return arbiters_.front().stats().counts().size(); }

  std::vector<BankArbiter> arbiters_;
  std::size_t port_count_;
  std::array<Route, kMostPorts> routes_{};
  std::array<std::uint32_t, kMostPorts> words_{};  // [port]: see place()
  PortMask routed_ = 0;
  std::array<PortMask, 64> ports_on_{};  // [bank]: the ports with a route to it
  PortMask writes_ = 0;                  // ports whose route writes
  PortMask placed_ = 0;                  // see placed()
  bool has_rows_ = false;                // see has_rows()
  PortMask visitors_ = 0;                // ports that have visited banks
  std::uint64_t visited_ = 0;
  std::uint64_t shared_ = 0;  // see shared()
  // Uncontended ports: each is alone on a bank that is not shared. They need no arbitration. Their grants are
  // added to the statistics when they cease to be alone, and when counting begins or ends.
  PortMask alone_ = 0;
  bool grants_all_ = false;                               // all ports count as alone
  std::array<std::uint64_t, kMostPorts> alone_grants_{};  // [port]
  std::vector<SharedBank> shared_banks_;                  // in the order of the banks
  std::array<std::uint8_t, 64> place_of_shared_{};        // [bank]: in shared_banks_
  std::vector<std::uint64_t> recorded_;                   // the counts when the recording began
};

}  // namespace stereotlm::memory
