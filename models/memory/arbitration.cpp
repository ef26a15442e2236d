#include "models/memory/arbitration.h"

#include <algorithm>
#include <stdexcept>

namespace stereotlm::memory {

static_assert(kBankCountRule.max <= 64, "shared() has a bit for each bank");

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
  shared_ = 0;
  set_route(port, bank, write);
  share_banks();
}

void Arbitration::unroute(Port port) {
  check_route(port, 0);
  settle();
  shared_ = 0;
  routed_ = static_cast<PortMask>(routed_ & ~mask_of(port));
  share_banks();
}

void Arbitration::visit(Port port, std::size_t bank, bool write) {
  check_route(port, bank);
  if (!is_shared(bank) || is_alone(port)) {
    settle(static_cast<PortMask>(ports_on(bank) | mask_of(port)));
    shared_ |= std::uint64_t{1} << bank;
    set_route(port, bank, write);
    share_banks();
    return;
  }
  for (SharedBank& shared : shared_banks_)
    shared.ports = static_cast<PortMask>(shared.ports & ~mask_of(port));
  SharedBank& shared = *find_shared(bank);
  shared.ports = static_cast<PortMask>(shared.ports | mask_of(port));
  set_route(port, bank, write);
}

void Arbitration::set_route(Port port, std::size_t bank, bool write) {
  routes_[port] = {bank, write};
  routed_ = static_cast<PortMask>(routed_ | mask_of(port));
  writes_ = static_cast<PortMask>((writes_ & ~mask_of(port)) | (write ? mask_of(port) : 0U));
}

Arbitration::SharedBank* Arbitration::find_shared(std::size_t bank) {
  return std::find_if(shared_banks_.begin(), shared_banks_.end(),
                      [bank](const SharedBank& shared) { return shared.bank == bank; });
}

PortMask Arbitration::ports_on(std::size_t bank) const {
  unsigned ports = 0;
  for (std::size_t port = 0; port < kMostPorts; ++port)
    ports |= unsigned{is_routed(port) && routes_[port].bank == bank} << port;
  return static_cast<PortMask>(ports);
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
  for (const auto& [decision, cycles] : decided) {
    if (decision >> 32U == 0) continue;
    BankArbiter::visit_stalls(
        static_cast<BankArbiter::Outcome>(decision),
        [&sums, count = cycles](Port port, std::size_t by) { sums[port][by] += count; });
  }
  std::vector<Stall> stalls;
  for (Port port = 0; port < kMostPorts; ++port) {
    for (std::size_t by = 0; by <= ArbiterStats::kTurnaround; ++by) {
      if (sums[port][by] != 0) stalls.push_back({port, by, sums[port][by]});
    }
  }
  return stalls;
}

// Finds the uncontended ports, and the shared banks in the order of their first ports. A bank that was shared
// stays so as long as it has a port.
void Arbitration::share_banks() {
  const std::uint64_t were_shared = std::exchange(shared_, 0);
  recording_ = false;
  alone_ = 0;
  shared_bank_count_ = 0;
  for (std::size_t port = 0; port < kMostPorts; ++port) {
    if (!is_routed(port)) continue;
    const std::size_t bank = routes_[port].bank;
    const PortMask together = ports_on(bank);
    if (lowest_port(together) != port) continue;
    if (together == mask_of(port) && (were_shared >> bank & 1U) == 0 && !arbiters_[bank].needs_turnaround()) {
      alone_ = static_cast<PortMask>(alone_ | mask_of(port));
    } else {
      shared_ |= std::uint64_t{1} << bank;
      shared_banks_[shared_bank_count_++] = {bank, &arbiters_[bank], together};
    }
  }
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
    arbiters_[routes_[port].bank].count_alone(mask_of(port), routes_[port].write, cycles[port]);
    alone_grants_[port] += cycles[port];
  }
}

// Counts modulo 2^64.
void Arbitration::retract_grants(Port port, std::uint64_t grants) {
  arbiters_[routes_[port].bank].count_alone(mask_of(port), routes_[port].write, 0 - grants);
  alone_grants_[port] -= grants;
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
    if (recording_)
      recorded_.push_back(static_cast<std::uint64_t>(shared - shared_banks_.data() + 1) << 32U | outcome);
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
  recorded_.clear();
}

Arbitration::Decided Arbitration::take_recorded() {
  recording_ = false;
  Decided decided;
  for (std::size_t ports = 1; ports < alone_cycles_.size(); ++ports) {
    const std::uint64_t cycles = alone_cycles_[ports] - alone_before_recording_[ports];
    if (cycles != 0) decided.emplace_back(ports, cycles);
  }
  std::sort(recorded_.begin(), recorded_.end());
  for (const std::uint64_t decision : recorded_) {
    if (decided.empty() || decided.back().first != decision) decided.emplace_back(decision, 0);
    ++decided.back().second;
  }
  return decided;
}

void Arbitration::skip_to(const State& state, std::uint64_t cycle, std::uint64_t cycles) {
  for (std::size_t i = 0; i < shared_bank_count_; ++i)
    shared_banks_[i].arbiter->skip_to(state[i], cycle, cycles);
}

void Arbitration::count_skipped(const Decided& decided, std::uint64_t times) {
  for (const auto& [decision, cycles] : decided) {
    if (decision >> 32U == 0) {
      alone_cycles_[decision] += cycles * times;
    } else {
      const auto outcome = static_cast<BankArbiter::Outcome>(decision);
      shared_banks_[(decision >> 32U) - 1].arbiter->count_skipped(outcome, cycles * times);
    }
  }
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
