#include "models/memory/arbitration.h"

#include <algorithm>
#include <stdexcept>

namespace stereotlm::memory {

static_assert(kBankCountRule.max <= 64, "visited() has a bit for each bank");

Arbitration::Arbitration(const ArbiterConfig& arbiter, const std::vector<SsramBankConfig>& banks)
    : port_count_(arbiter.priority.size()) {
  arbiters_.reserve(banks.size());
  for (const SsramBankConfig& bank : banks) arbiters_.emplace_back(arbiter, bank);
}

std::string Arbitration::route_problem(Port port, std::size_t bank) const {
  const auto problem = [](const char* field, std::size_t value, std::size_t count) {
    return field + (" = " + std::to_string(value)) + ": must be 0.." + std::to_string(count - 1);
  };
  if (port >= port_count_) return problem("port", port, port_count_);
  return bank >= arbiters_.size() ? problem("bank", bank, arbiters_.size()) : "";
}

void Arbitration::check_route(Port port, std::size_t bank) const {
  const std::string problem = route_problem(port, bank);
  if (!problem.empty()) throw std::invalid_argument(problem);
}

void Arbitration::route(Port port, std::size_t bank, bool write) {
  check_route(port, bank);
  settle();
  visited_ = 0;
  set_route(port, bank, write);
  share_banks();
}

void Arbitration::unroute(Port port) {
  check_route(port, 0);
  settle();
  visited_ = 0;
  routed_ = static_cast<PortMask>(routed_ & ~mask_of(port));
  share_banks();
}

void Arbitration::visit(Port port, std::size_t bank, bool write) {
  check_route(port, bank);
  const std::size_t index = index_of_shared(bank);
  if (index == shared_bank_count_ || is_alone(port)) {
    PortMask ports = mask_of(port);
    for (std::size_t other = 0; other < kMostPorts; ++other) {
      if (is_routed(other) && routes_[other].bank == bank)
        ports = static_cast<PortMask>(ports | mask_of(other));
    }
    settle(ports);
    visited_ |= std::uint64_t{1} << bank;
    set_route(port, bank, write);
    share_banks();
    return;
  }
  if (is_routed(port)) {
    const std::size_t left = index_of_shared(routes_[port].bank);
    if (left != shared_bank_count_)
      shared_banks_[left].ports = static_cast<PortMask>(shared_banks_[left].ports & ~mask_of(port));
  }
  shared_banks_[index].ports = static_cast<PortMask>(shared_banks_[index].ports | mask_of(port));
  set_route(port, bank, write);
}

void Arbitration::set_route(Port port, std::size_t bank, bool write) {
  routes_[port] = {bank, write};
  routed_ = static_cast<PortMask>(routed_ | mask_of(port));
  writes_ = static_cast<PortMask>((writes_ & ~mask_of(port)) | (write ? mask_of(port) : 0U));
}

// The index of a bank in shared_banks_, or their number.
std::size_t Arbitration::index_of_shared(std::size_t bank) const {
  std::size_t index = 0;
  while (index < shared_bank_count_ && shared_banks_[index].bank != bank) ++index;
  return index;
}

bool Arbitration::is_used_beside(Port port, std::size_t bank) const {
  for (std::size_t other = 0; other < kMostPorts; ++other) {
    if (other != port && is_routed(other) && routes_[other].bank == bank) return true;
  }
  return false;
}

std::size_t Arbitration::cause_of(Port port, PortMask granted) const {
  const Route& route = routes_[port];
  const bool is_apart = arbiters_[route.bank].separates_directions();
  for (unsigned ports = granted; ports != 0; ports &= ports - 1) {
    const Port other = lowest_port(static_cast<PortMask>(ports));
    if (routes_[other].bank == route.bank && (!is_apart || routes_[other].write == route.write)) return other;
  }
  return ArbiterStats::kTurnaround;
}

std::vector<Stall> Arbitration::stalls_of(const Decided& decided) {
  std::array<std::array<std::uint64_t, kMostPorts + 1>, kMostPorts> sums{};  // [port][by]
  for (const Decided::Shared& shared : decided.shared) {
    BankArbiter::visit_stalls(shared.outcome,
                              [&](Port port, std::size_t by) { sums[port][by] += shared.cycles; });
  }
  std::vector<Stall> stalls;
  for (Port port = 0; port < kMostPorts; ++port) {
    for (std::size_t by = 0; by <= ArbiterStats::kTurnaround; ++by) {
      if (sums[port][by] != 0) stalls.push_back({port, by, sums[port][by]});
    }
  }
  return stalls;
}

BankArbiter::Outcome Arbitration::decide_unrouted(std::size_t bank, std::uint64_t cycle, Port port,
                                                  bool write) {
  return arbiters_[bank].decide(cycle, mask_of(port), write ? mask_of(port) : PortMask{0});
}

// Finds the uncontended ports and the shared banks. Visited banks without a port are forgotten.
void Arbitration::share_banks() {
  recording_ = false;
  alone_ = 0;
  shared_bank_count_ = 0;
  std::uint64_t visited = 0;
  std::array<PortMask, kMostPorts> together{};  // [port]: the ports on its bank
  for (std::size_t i = 0; i < kMostPorts; ++i) {
    if (!is_routed(i)) continue;
    for (std::size_t other = 0; other < kMostPorts; ++other) {
      const bool same_bank = is_routed(other) && routes_[other].bank == routes_[i].bank;
      together[i] = static_cast<PortMask>(together[i] | unsigned{same_bank} << other);
    }
  }
  for (std::size_t i = 0; i < kMostPorts; ++i) {
    const auto port_mask = static_cast<PortMask>(1U << i);
    if (together[i] == 0 || lowest_port(together[i]) != i) continue;
    const std::size_t bank = routes_[i].bank;
    BankArbiter& arbiter = arbiters_[bank];
    const std::uint64_t visit = visited_ & std::uint64_t{1} << bank;
    visited |= visit;
    if (together[i] == port_mask && !arbiter.needs_turnaround() && visit == 0) {
      alone_ = static_cast<PortMask>(alone_ | port_mask);
    } else {
      SharedBank& shared = shared_banks_[shared_bank_count_++];
      shared.bank = bank;
      shared.arbiter = &arbiter;
      shared.ports = together[i];
    }
  }
  visited_ = visited;
}

// Adds the grants of uncontended ports to the counts of the arbiters.
void Arbitration::count_alone() const {
  std::array<std::uint64_t, kMostPorts> cycles{};
  for (std::size_t ports_alone = 1; ports_alone < alone_cycles_.size(); ++ports_alone) {
    if (alone_cycles_[ports_alone] == 0) continue;
    for (std::size_t port = 0; port < kMostPorts; ++port)
      cycles[port] += (ports_alone >> port & 1U) * alone_cycles_[ports_alone];
  }
  for (std::size_t ports = 0; recording_ && ports < alone_cycles_.size(); ++ports)
    alone_before_recording_[ports] -= alone_cycles_[ports];
  alone_cycles_ = {};
  for (std::size_t port = 0; port < kMostPorts; ++port) {
    const std::uint64_t grants = cycles[port] - retracted_grants_[port];
    arbiters_[routes_[port].bank].count_alone(mask_of(port), routes_[port].write, grants);
    alone_grants_[port] += grants;
  }
  retracted_grants_ = {};
}

// To be called when no grant of these ports can be retracted any more: counts as count_alone() does, and
// moves the states of the policies by their grants.
void Arbitration::settle(PortMask ports) {
  count_alone();
  for (std::size_t port = 0; port < kMostPorts; ++port) {
    if ((ports & mask_of(port)) == 0 || alone_grants_[port] == 0) continue;
    arbiters_[routes_[port].bank].grant_alone(mask_of(port), routes_[port].write);
    alone_grants_[port] = 0;
  }
}

// The part of arbitrate() for requests to shared_banks_.
PortMask Arbitration::arbitrate_shared(std::uint64_t cycle, PortMask requests) {
  PortMask granted = 0;
  SharedBank* const end = shared_banks_.data() + shared_bank_count_;
  for (SharedBank* shared = shared_banks_.data(); shared != end; ++shared) {
    const auto asking = static_cast<PortMask>(requests & shared->ports);
    if (asking == 0) continue;
    BankArbiter& arbiter = *shared->arbiter;
    const BankArbiter::Outcome outcome = arbiter.decide(cycle, asking, writes_);
    arbiter.count(cycle, outcome);
    if (recording_) shared->recorded.push_back(outcome);
    granted = static_cast<PortMask>(granted | arbiter.granted_in(outcome));
  }
  return granted;
}

Arbitration::State Arbitration::state(std::uint64_t cycle) const {
  State state{};
  for (std::size_t i = 0; i < shared_bank_count_; ++i) state[i] = shared_banks_[i].arbiter->state(cycle);
  return state;
}

void Arbitration::begin_recording() {
  recording_ = true;
  alone_before_recording_ = alone_cycles_;
  for (std::size_t i = 0; i < shared_bank_count_; ++i) shared_banks_[i].recorded.clear();
}

Arbitration::Decided Arbitration::take_recorded() {
  recording_ = false;
  Decided decided;
  for (std::size_t ports = 1; ports < alone_cycles_.size(); ++ports) {
    const std::uint64_t cycles = alone_cycles_[ports] - alone_before_recording_[ports];
    if (cycles != 0) decided.alone.push_back({ports, cycles});
  }
  for (std::size_t bank = 0; bank < shared_bank_count_; ++bank) {
    std::vector<BankArbiter::Outcome>& recorded = shared_banks_[bank].recorded;
    std::sort(recorded.begin(), recorded.end());
    for (auto first = recorded.begin(); first != recorded.end();) {
      const auto last = std::upper_bound(first, recorded.end(), *first);
      decided.shared.push_back({bank, *first, static_cast<std::uint64_t>(last - first)});
      first = last;
    }
  }
  return decided;
}

void Arbitration::skip_to(const State& state, std::uint64_t cycle, std::uint64_t cycles) {
  for (std::size_t i = 0; i < shared_bank_count_; ++i)
    shared_banks_[i].arbiter->skip_to(state[i], cycle, cycles);
}

void Arbitration::count_skipped(const Decided& decided, std::uint64_t times) {
  for (const auto& [ports, cycles] : decided.alone) alone_cycles_[ports] += cycles * times;
  for (const auto& [bank, outcome, cycles] : decided.shared)
    shared_banks_[bank].arbiter->count_skipped(outcome, cycles * times);
}

void Arbitration::begin_counting(std::uint64_t first_cycle) {
  settle();
  for (BankArbiter& arbiter : arbiters_) arbiter.begin_counting(first_cycle);
}

void Arbitration::end_counting(std::uint64_t end_cycle) {
  settle();
  for (BankArbiter& arbiter : arbiters_) arbiter.end_counting(end_cycle);
}

}  // namespace stereotlm::memory
