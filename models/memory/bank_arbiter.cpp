#include "models/memory/bank_arbiter.h"

#include <memory>
#include <stdexcept>

#include "models/memory/arbitration_policies.h"

namespace stereotlm::memory {
namespace {

static_assert(
    [] {
      for (const BankTraits& bank : kBankTraits) {
        if (bank.ports != 1) return false;
      }
      return true;
    }(),
    "an arbiter grants one access a cycle: a bank with more ports needs an arbiter for each");

std::unique_ptr<const ArbitrationPolicy> make_policy(const ArbiterConfig& config) {
  if (const auto found = problems(config); !found.empty()) throw std::invalid_argument(found.front());
  return find_arbitration_policy(config.policy)->make(config.priority);
}

}  // namespace

BankArbiter::BankArbiter(const ArbiterConfig& config, int turnaround_cycles)
    : table_(make_policy(config)),
      row_(&table_.row_of(0)),
      other_direction_cycles_(static_cast<std::uint64_t>(turnaround_cycles) + 1) {}

// Fills a missing row or decision, then decides. Seldom called, and out of line so that decide() stays small.
BankArbiter::Outcome BankArbiter::prepare_and_decide(std::uint64_t cycle, PortMask requests,
                                                     PortMask writes) {
  row_ = &row_at(cycle);
  next_cycle_ = cycle;
  table_.fill(*row_, requests);
  return decide(cycle, requests, writes);
}

// The row of the policy's state in `cycle`, after cycles without request since next_cycle_.
DecisionTable::Row& BankArbiter::row_at(std::uint64_t cycle) const {
  return row_->after_idle_cycles(cycle - next_cycle_);
}

void BankArbiter::count_alone(PortMask port, bool write, std::uint64_t cycles) {
  if (cycles == 0) return;
  if (counting_) {
    outcomes_[outcome_of(port, lowest_port(port), write ? 1 : 0)] += cycles;
    // All cycles up to the next call that are not counted here were idle. Their order does not matter.
    next_uncounted_cycle_ += cycles;
  } else {
    uncounted_accesses_ += cycles;
  }
}

// The first grant moves the state. Each further one acts as a cycle without request does (see
// ArbitrationPolicy).
void BankArbiter::grant_alone(PortMask port) {
  table_.fill(*row_, port);
  row_ = row_->decisions[port].if_granted;
  ++next_cycle_;
}

std::uint64_t BankArbiter::state(std::uint64_t cycle) const {
  const auto wait = [cycle](std::uint64_t ready) { return ready > cycle ? ready - cycle : 0; };
  return row_at(cycle).state | wait(ready_cycle_[0]) << 32U | wait(ready_cycle_[1]) << 48U;
}

void BankArbiter::skip_to(std::uint64_t state, std::uint64_t cycle, std::uint64_t cycles) {
  static_assert(kTurnaroundRule.max < 0xffff);
  row_ = &table_.row_of(static_cast<ArbitrationPolicy::State>(state));
  next_cycle_ = cycle;
  ready_cycle_ = {cycle + (state >> 32U & 0xffffU), cycle + (state >> 48U)};
  if (!counting_) return;
  next_uncounted_cycle_ += cycles;
  idle_cycles_ += cycles;
}

void BankArbiter::count_skipped(Outcome outcome, std::uint64_t cycles) {
  if (counting_) {
    outcomes_[outcome] += cycles;
    idle_cycles_ -= cycles;
  } else if (granted_in(outcome) != 0) {
    uncounted_accesses_ += cycles;
  }
}

void BankArbiter::begin_counting(std::uint64_t first_cycle) {
  counting_ = true;
  next_uncounted_cycle_ = first_cycle;
}

void BankArbiter::end_counting(std::uint64_t end_cycle) {
  idle_cycles_ += end_cycle - next_uncounted_cycle_;
  counting_ = false;
}

ArbiterStats BankArbiter::stats() const {
  ArbiterStats stats;
  stats.idle_cycles = idle_cycles_;
  for (std::size_t by = 0; by <= kMostPorts; ++by) {
    for (std::size_t requests = 1; requests < kMasks; ++requests) {
      const std::uint64_t reads = outcomes_[outcome_of(requests, by, 0)];
      const std::uint64_t writes = outcomes_[outcome_of(requests, by, 1)];
      const std::uint64_t cycles = reads + writes;
      if (cycles == 0) continue;
      if ((requests & (requests - 1)) != 0) stats.contended_cycles += cycles;
      if (by == ArbiterStats::kTurnaround) {
        stats.turnaround_cycles += cycles;
      } else {
        stats.reads += reads;
        stats.writes += writes;
        stats.grants[by] += cycles;
      }
      for (std::size_t port = 0; port < kMostPorts; ++port) {
        if (port != by && (requests >> port & 1U) != 0) stats.blame[port][by] += cycles;
      }
    }
  }
  return stats;
}

}  // namespace stereotlm::memory
