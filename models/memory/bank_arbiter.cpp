#include "models/memory/bank_arbiter.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "models/checked.h"

namespace stereotlm::memory {
namespace {

constexpr bool contend(PortMask requests) { return (requests & (requests - 1)) != 0; }

// Ports of an order in a word of a state.
constexpr std::size_t kPortsOfWord = 8;

}  // namespace

// With separate ports an access never delays one in the other direction: both may be granted in one cycle. A
// read of sdram keeps the pins until its word has left them. Its write keeps nobody from reading.
BankArbiter::BankArbiter(const ArbiterConfig& config, const SsramBankConfig& bank)
    : policy_(find_arbitration_policy(checked(config).policy)),
      list_(config.priority),
      ports_(mask_of(list_.size()) - 1),
      has_separate_ports_(has_separate_ports(checked(bank).kind)),
      has_turnaround_(traits_of(bank.kind).has_turnaround || bank.sdram),
      orders_{list_, list_},
      rows_(bank.sdram),
      stats_(list_.size()) {
  const auto cycles = static_cast<std::uint64_t>(bank.turnaround_cycles) + 1;
  other_direction_cycles_ = {cycles, cycles};
  if (has_separate_ports_) other_direction_cycles_ = {0, 0};
  if (bank.sdram) other_direction_cycles_ = {static_cast<std::uint64_t>(bank.sdram->cas_latency) + 1, 0};
}

BankArbiter::Outcome BankArbiter::decide(std::uint64_t cycle, PortMask requests, PortMask writes,
                                         const std::uint32_t* words) {
  if (requests == 0 || (requests & ~ports_) != 0) {
    throw std::invalid_argument("requests: must be one or more of the ports 0.." +
                                std::to_string(list_.size() - 1) + ", and no other");
  }
  // The most frequent case; a frame of the whole computer with timing only then takes 0.97 of the time.
  if (policy_->advance == nullptr && grants_at_once() && !contend(requests)) {
    next_cycle_ = cycle + 1;
    return {requests, requests & writes, requests};
  }
  // Any number of cycles without request acts as one does.
  if (cycle != next_cycle_) {
    for (PriorityList& order : orders_) advance(order, 0, 0);
  }
  next_cycle_ = cycle + 1;
  Outcome outcome{requests, requests & writes};
  if (has_separate_ports_) {
    decide_direction(orders_[0], cycle, requests & ~writes, words, outcome);
    decide_direction(orders_[1], cycle, requests & writes, words, outcome);
  } else {
    decide_direction(orders_[0], cycle, requests, words, outcome);
  }
  return outcome;
}

// Adds the port that is granted to the outcome, or the cause for which none is.
void BankArbiter::decide_direction(PriorityList& order, std::uint64_t cycle, PortMask requests,
                                   const std::uint32_t* words, Outcome& outcome) {
  const auto cause_of = [](SdramRows::Cause cause) {
    return cause == SdramRows::Cause::kRow ? kRow : kRefresh;
  };
  PortMask granted = 0;
  const auto busy = rows_ ? rows_->busy_with(cycle) : std::nullopt;
  if (busy) {
    outcome.cause = cause_of(*busy);
  } else if (requests != 0) {
    const PortMask winner =
        contend(requests) ? mask_of(*std::find_if(order.begin(), order.end(),
                                                  [requests](Port port) { return has(requests, port); }))
                          : requests;
    const std::size_t write = (outcome.writes & winner) != 0 ? 1 : 0;
    if (rows_ && !rows_->may_access(cycle, words[lowest_port(winner)])) {
      outcome.cause = kRow;
    } else if (cycle >= ready_cycle_[write]) {
      granted = winner;
      ready_cycle_[1 - write] = cycle + other_direction_cycles_[write];
    }
  }
  outcome.granted |= granted;
  advance(order, requests, granted);
}

void BankArbiter::count(const Outcome& outcome, std::uint64_t cycles) {
  const auto reads = outcome.requests & ~outcome.writes;
  if (!counting_) {
    stats_.add(ArbiterStats::kUncounted,
               cycles * (contend(outcome.granted) ? 2U : unsigned{outcome.granted != 0}));
  } else if (has_separate_ports_) {
    count_direction(reads, outcome.granted & reads, false, outcome.cause, cycles);
    count_direction(outcome.writes, outcome.granted & outcome.writes, true, outcome.cause, cycles);
    if (contend(outcome.granted)) stats_.add(ArbiterStats::kBusy, 0 - cycles);  // of two grants in one cycle
    if (contend(reads) && contend(outcome.writes)) stats_.add(ArbiterStats::kContended, 0 - cycles);
  } else {
    count_direction(outcome.requests, outcome.granted, (outcome.granted & outcome.writes) != 0, outcome.cause,
                    cycles);
    if (outcome.granted == 0 && outcome.cause == kTurnaround)
      stats_.add(ArbiterStats::kTurnaroundCycles, cycles);
  }
}

void BankArbiter::count_direction(PortMask requests, PortMask granted, bool write, std::size_t cause,
                                  std::uint64_t cycles) {
  if (contend(requests)) stats_.add(ArbiterStats::kContended, cycles);
  std::size_t by = cause;
  if (granted != 0) {
    by = lowest_port(granted);
    stats_.add(write ? ArbiterStats::kWrites : ArbiterStats::kReads, cycles);
    stats_.add(ArbiterStats::kBusy, cycles);
    stats_.add(stats_.grants_place(by), cycles);
  }
  for_each_port(requests & ~granted, [&](Port port) { stats_.add(stats_.blame_place(port, by), cycles); });
}

void BankArbiter::count_rows(std::uint64_t end_cycle) {
  if (!rows_) return;
  const auto [cycles, begun] = rows_->take(end_cycle);
  stats_.add(ArbiterStats::kRowsOpened, begun[0]);
  stats_.add(counting_ ? ArbiterStats::kRefreshes : ArbiterStats::kUncountedRefreshes, begun[1]);
  if (!counting_) return;
  stats_.add(ArbiterStats::kRowCycles, cycles[0]);
  stats_.add(ArbiterStats::kRefreshCycles, cycles[1]);
}

// The first grant moves the order. Each further one acts as a cycle without request does.
void BankArbiter::grant_alone(Port port, bool write) {
  PriorityList& order = orders_[has_separate_ports_ && write ? 1 : 0];
  advance(order, mask_of(port), mask_of(port));
  ++next_cycle_;
}

void BankArbiter::append_state(std::uint64_t cycle, StateWords& state) const {
  const bool is_idle_since = cycle != next_cycle_;
  for (PriorityList order : orders_) {
    if (is_idle_since) advance(order, 0, 0);
    for (std::size_t place = 0; place < order.size(); ++place) {
      if (place % kPortsOfWord == 0) state.push_back(0);
      state.back() = state.back() << 8U | order[place];
    }
    if (!has_separate_ports_) break;
  }
  if (!has_turnaround_) return;
  for (const std::uint64_t ready : ready_cycle_) state.push_back(ready > cycle ? ready - cycle : 0);
}

void BankArbiter::set_state(std::uint64_t cycle, StateReader& state) {
  next_cycle_ = cycle;
  for (PriorityList& order : orders_) {
    for (std::size_t first = 0; first < order.size(); first += kPortsOfWord) {
      std::uint64_t word = *state++;
      for (std::size_t place = std::min(first + kPortsOfWord, order.size()); place-- > first; word >>= 8U)
        order[place] = word & 0xffU;
    }
    if (!has_separate_ports_) break;
  }
  if (!has_turnaround_) return;
  for (std::uint64_t& ready : ready_cycle_) ready = cycle + *state++;
}

void BankArbiter::begin_counting(std::uint64_t first_cycle) {
  count_rows(first_cycle);
  counting_ = true;
  first_counted_cycle_ = first_cycle;
}

void BankArbiter::end_counting(std::uint64_t end_cycle) {
  count_rows(end_cycle);
  counting_ = false;
  counted_cycles_ += end_cycle - first_counted_cycle_;
  stats_.add(ArbiterStats::kIdle, counted_cycles_ - stats_.busy_cycles() - stats_.turnaround_cycles() -
                                      stats_.row_cycles() - stats_.refresh_cycles() - stats_.idle_cycles());
}

}  // namespace stereotlm::memory
