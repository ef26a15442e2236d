#include "models/memory/bank_arbiter.h"

#include <stdexcept>
#include <string>

#include "models/checked.h"

namespace stereotlm::memory {
namespace {

constexpr bool contend(std::size_t requests) { return (requests & (requests - 1)) != 0; }

}  // namespace

// With separate ports an access never delays one in the other direction: both may be granted in one cycle.
BankArbiter::BankArbiter(const ArbiterConfig& config, const SsramBankConfig& bank)
    : policy_(find_arbitration_policy(checked(config).policy)),
      list_(config.priority),
      has_separate_ports_(has_separate_ports(checked(bank).kind)),
      positions_{PolicyPosition{&row_of(0)}, PolicyPosition{&row_of(0)}},
      other_direction_cycles_(has_separate_ports_ ? 0
                                                  : static_cast<std::uint64_t>(bank.turnaround_cycles) + 1) {}

BankArbiter::Row& BankArbiter::row_of(ArbitrationPolicy::State state) {
  const auto [entry, is_new] = rows_.try_emplace(state);
  Row& row = entry->second;
  if (is_new) {
    row.state = state;
    row.after_idle = &row_of(policy_->next(list_, state, 0, 0));
  }
  return row;
}

// Computes a decision of the row if it is not known. Every decision is computed before it is used, so its
// requests are checked here, and not in each cycle.
const BankArbiter::Decision& BankArbiter::decision_of(Row& row, PortMask requests) {
  if (requests == 0 || (requests >> list_.size()) != 0) {
    throw std::invalid_argument("requests = " + std::to_string(unsigned{requests}) +
                                ": must be a mask of one or more of the ports 0.." +
                                std::to_string(list_.size() - 1));
  }
  Decision& decision = row.decisions[requests];
  if (decision.is_known()) return decision;
  decision.winner = policy_->winner(list_, row.state, requests);
  decision.if_granted = &row_of(policy_->next(list_, row.state, requests, mask_of(decision.winner)));
  decision.if_refused = &row_of(policy_->next(list_, row.state, requests, 0));
  return decision;
}

// Fills a missing row or decision, then decides. Seldom called, and out of line so that decide() stays small.
BankArbiter::Outcome BankArbiter::prepare_and_decide(PolicyPosition& position, std::uint64_t cycle,
                                                     PortMask requests, PortMask writes) {
  position = {&position.at(cycle), cycle};
  decision_of(*position.row, requests);
  return decide_at(position, cycle, requests, writes);
}

BankArbiter::Outcome BankArbiter::decide_each_direction(std::uint64_t cycle, PortMask requests,
                                                        PortMask writes) {
  const auto reading = static_cast<PortMask>(requests & ~writes);
  const auto writing = static_cast<PortMask>(requests & writes);
  const Outcome reads = reading == 0 ? kNothing : decide_at(positions_[0], cycle, reading, 0);
  const Outcome written = writing == 0 ? kNothing : decide_at(positions_[1], cycle, writing, writing);
  return reads | written << kHalf;
}

// Counts the upper half of an outcome of a bank with separate ports, and what both halves have in common.
void BankArbiter::add_writes(Outcome outcome, std::uint64_t cycles) {
  const Outcome reads = outcome & kHalfMask;
  const Outcome writes = outcome >> kHalf;
  outcomes_[writes] += cycles;
  if (granted_in_half(reads) != 0 && granted_in_half(writes) != 0) both_granted_cycles_ += cycles;
  if (contend(reads & (kMasks - 1)) && contend(writes & (kMasks - 1))) both_contended_cycles_ += cycles;
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
void BankArbiter::grant_alone(PortMask port, bool write) {
  PolicyPosition& position = position_of(write);
  position.row = decision_of(*position.row, port).if_granted;
  ++position.next_cycle;
}

std::uint64_t BankArbiter::state(std::uint64_t cycle) const {
  const auto wait = [cycle](std::uint64_t ready) { return ready > cycle ? ready - cycle : 0; };
  const std::uint64_t state = positions_[0].at(cycle).state;
  if (has_separate_ports_) return state | std::uint64_t{positions_[1].at(cycle).state} << 32U;
  return state | wait(ready_cycle_[0]) << 32U | wait(ready_cycle_[1]) << 48U;
}

void BankArbiter::skip_to(std::uint64_t state, std::uint64_t cycle, std::uint64_t cycles) {
  static_assert(kTurnaroundRule.max < 0xffff);
  positions_[0] = {&row_of(static_cast<ArbitrationPolicy::State>(state)), cycle};
  if (has_separate_ports_) {
    positions_[1] = {&row_of(static_cast<ArbitrationPolicy::State>(state >> 32U)), cycle};
  } else {
    ready_cycle_ = {cycle + (state >> 32U & 0xffffU), cycle + (state >> 48U)};
  }
  next_uncounted_cycle_ += cycles;
  idle_cycles_ += cycles;
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
      if (contend(requests)) stats.contended_cycles += cycles;
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
  stats.busy_cycles = stats.reads + stats.writes - both_granted_cycles_;
  stats.contended_cycles -= both_contended_cycles_;
  return stats;
}

}  // namespace stereotlm::memory
