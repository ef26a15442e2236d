#include "models/memory/arbitration.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>

namespace stereotlm::memory {

static_assert(kBankCountRule.max <= 64, "shared() has a bit for each bank");

namespace {

// A cycle in which the port alone requests and is granted.
constexpr BankArbiter::Outcome alone_outcome(Port port, bool write) {
  const PortMask mask = mask_of(port);
  return {mask, write ? mask : PortMask{0}, mask};
}

}  // namespace

Arbitration::Arbitration(const ArbiterConfig& arbiter, const std::vector<SsramBankConfig>& banks)
    : port_count_(arbiter.priority.size()) {
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

void Arbitration::route_stripe(Port port, std::uint64_t banks, bool write) {
  const auto first = static_cast<std::size_t>(__builtin_ctzll(banks));
  check_route(port, 63 - static_cast<std::size_t>(__builtin_clzll(banks)));
  count_alone(alone_);
  forget_visits();
  routes_[port] = {first, write, banks};
  routed_ |= mask_of(port);
  share_banks();
}

void Arbitration::unroute(Port port) {
  check_route(port, 0);
  count_alone(alone_);
  forget_visits();
  routed_ &= ~mask_of(port);
  share_banks();
}

void Arbitration::visit(Port port, std::size_t bank, bool write) {
  check_route(port, bank);
  const bool is_known = has(routed_ & visitors_, port) && (routes_[port].banks & bank_bit(bank)) != 0;
  if (!is_known || !is_shared(bank)) {
    count_alone(ports_on(bank) | mask_of(port));
    if (!has(routed_, port)) routes_[port].banks = 0;
    routes_[port].banks |= bank_bit(bank);
    visitors_ |= mask_of(port);
    visited_ |= bank_bit(bank);
    routed_ |= mask_of(port);
    routes_[port].bank = bank;
    routes_[port].write = write;
    share_banks();
    return;
  }
  routes_[port].write = write;
  writes_ = (writes_ & ~mask_of(port)) | (write ? mask_of(port) : 0);
  if (routes_[port].bank != bank) move(port, bank);
}

// Each port that has visited banks stays on the last of them.
void Arbitration::forget_visits() {
  for_each_port(visitors_, [this](Port port) { routes_[port].banks = bank_bit(routes_[port].bank); });
  visitors_ = 0;
  visited_ = 0;
}

// Lets the port request another one of its banks.
void Arbitration::move(Port port, std::size_t bank) {
  const std::size_t from = std::exchange(routes_[port].bank, bank);
  if (grants_all_) return;
  shared_banks_[place_of_shared_[from]].ports &= ~mask_of(port);
  shared_banks_[place_of_shared_[bank]].ports |= mask_of(port);
}

std::size_t Arbitration::cause_of(Port port, PortMask granted) const {
  const Route& route = routes_[port];
  const bool is_apart = arbiters_[route.bank].separates_directions();
  for (PortMask ports = granted; ports != 0; ports &= ports - 1) {
    const Port other = lowest_port(ports);
    if (routes_[other].bank == route.bank && (!is_apart || routes_[other].write == route.write)) return other;
  }
  return shared_banks_[place_of_shared_[route.bank]].cause;
}

// Finds the uncontended ports and the shared banks.
void Arbitration::share_banks() {
  writes_ = 0;
  placed_ = 0;
  has_rows_ = false;
  ports_on_ = {};
  for_each_port(routed_, [this](Port port) {
    for (std::uint64_t banks = routes_[port].banks; banks != 0; banks &= banks - 1)
      ports_on_[static_cast<std::size_t>(__builtin_ctzll(banks))] |= mask_of(port);
    if (routes_[port].write) writes_ |= mask_of(port);
    if ((routes_[port].banks & (routes_[port].banks - 1)) != 0 && !has(visitors_, port))
      placed_ |= mask_of(port);
  });
  alone_ = 0;
  shared_ = 0;
  shared_banks_.clear();
  for (std::size_t bank = 0; bank < arbiters_.size(); ++bank) {
    const PortMask together = ports_on(bank);
    if (together == 0) continue;
    BankArbiter& arbiter = arbiters_[bank];
    if (arbiter.has_rows()) {
      placed_ |= together;
      has_rows_ = true;
    }
    const Port first = lowest_port(together);
    if (together == mask_of(first) && routes_[first].banks == bank_bit(bank) &&
        (visited_ & bank_bit(bank)) == 0 && arbiter.grants_at_once()) {
      alone_ |= together;
      continue;
    }
    shared_ |= bank_bit(bank);
    place_of_shared_[bank] = static_cast<std::uint8_t>(shared_banks_.size());
    PortMask next = 0;
    for_each_port(together, [&](Port port) { next |= routes_[port].bank == bank ? mask_of(port) : 0; });
    shared_banks_.push_back({bank, &arbiter, next});
  }
  if (!grants_all_) return;
  alone_ = routed_;
  placed_ = 0;
  has_rows_ = false;
  shared_ = 0;
  shared_banks_.clear();
}

// Adds the grants of these uncontended ports to the statistics, and moves the orders of their policies.
void Arbitration::count_alone(PortMask ports) {
  for_each_port(ports & alone_, [this](Port port) {
    const std::uint64_t grants = std::exchange(alone_grants_[port], 0);
    if (grants == 0) return;
    const Route& route = routes_[port];
    arbiters_[route.bank].count(alone_outcome(port, route.write), grants);
    arbiters_[route.bank].grant_alone(port, route.write);
  });
}

// The part of arbitrate() for requests to shared_banks_.
PortMask Arbitration::arbitrate_shared(std::uint64_t cycle, PortMask requests) {
  PortMask granted = 0;
  for (SharedBank& shared : shared_banks_) {
    const auto asking = requests & shared.ports;
    if (asking == 0) continue;
    if (shared.arbiter->has_rows()) shared.arbiter->count_rows(cycle);
    const BankArbiter::Outcome outcome = shared.arbiter->decide(cycle, asking, writes_, words_.data());
    shared.arbiter->count(outcome);
    granted |= outcome.granted;
    shared.cause = outcome.cause;
  }
  return granted;
}

void Arbitration::append_state(std::uint64_t cycle, StateWords& state) const {
  for (const SharedBank& shared : shared_banks_) shared.arbiter->append_state(cycle, state);
}

void Arbitration::set_state(std::uint64_t cycle, StateReader& state) {
  for (const SharedBank& shared : shared_banks_) shared.arbiter->set_state(cycle, state);
}

std::vector<std::uint64_t> Arbitration::counts() const {
  std::vector<std::uint64_t> counts(alone_grants_.begin(),
                                    alone_grants_.begin() + static_cast<std::ptrdiff_t>(port_count_));
  for (const SharedBank& shared : shared_banks_) {
    const std::vector<std::uint64_t>& of_bank = shared.arbiter->stats().counts();
    counts.insert(counts.end(), of_bank.begin(), of_bank.end());
  }
  return counts;
}

CountChanges Arbitration::take_recorded() const {
  CountChanges changes;
  const std::vector<std::uint64_t> now = counts();
  for (std::size_t place = 0; place < now.size(); ++place) {
    if (now[place] != recorded_[place])
      changes.emplace_back(static_cast<std::uint32_t>(place), now[place] - recorded_[place]);
  }
  return changes;
}

void Arbitration::count_skipped(const CountChanges& changes, std::uint64_t times) {
  const std::size_t counts = counts_of_bank();
  auto bank = shared_banks_.begin();
  std::size_t first = port_count_;  // place of the bank; the changes are in the order of their places
  for (const auto& [place, change] : changes) {
    if (place < port_count_) {
      alone_grants_[place] += change * times;
      continue;
    }
    for (; place >= first + counts; first += counts) ++bank;
    bank->arbiter->count_skipped(place - first, change * times);
  }
}

std::vector<BankUse> Arbitration::bank_uses(const CountChanges& changes) const {
  std::vector<BankUse> uses;
  const ArbiterStats& stats = arbiters_.front().stats();
  for (const auto& [place, change] : changes) {
    if (place < port_count_) {
      uses.push_back({place, BankUse::kAlone, kGranted, change});
      continue;
    }
    const std::size_t bank = (place - port_count_) / counts_of_bank();
    if (const auto use = stats.use_at((place - port_count_) % counts_of_bank()))
      uses.push_back({use->first, bank, use->second, change});
  }
  std::sort(uses.begin(), uses.end(), [](const BankUse& a, const BankUse& b) {
    return std::tie(a.port, a.shared_bank, a.by) < std::tie(b.port, b.shared_bank, b.by);
  });
  return uses;
}

void Arbitration::begin_counting(std::uint64_t first_cycle) {
  count_alone(alone_);
  for (BankArbiter& arbiter : arbiters_) arbiter.begin_counting(first_cycle);
}

void Arbitration::end_counting(std::uint64_t end_cycle) {
  count_alone(alone_);
  for (BankArbiter& arbiter : arbiters_) arbiter.end_counting(end_cycle);
}

// Adds the grants since the last count_alone(): in all of their cycles counting is on, or in none.
ArbiterStats Arbitration::stats(std::size_t bank, std::uint64_t end_cycle) const {
  BankArbiter arbiter = arbiters_[bank];
  arbiter.count_rows(end_cycle);
  for_each_port(alone_, [&](Port port) {
    if (routes_[port].bank == bank)
      arbiter.count(alone_outcome(port, routes_[port].write), alone_grants_[port]);
  });
  return arbiter.stats();
}

}  // namespace stereotlm::memory
