#include "models/memory/bank_arbiter.h"

namespace stereotlm::memory {
namespace {

std::size_t place_of(const ArbiterConfig& config, PortMask port) {
  std::size_t place = 0;
  while (mask_of(config.priority[place]) != port) ++place;
  return place;
}

}  // namespace

BankArbiter::BankArbiter(const ArbiterConfig& config, int turnaround_cycles)
    : other_direction_cycles_(static_cast<std::uint64_t>(turnaround_cycles) + 1) {
  const bool rotates = config.policy == ArbitrationPolicy::kRoundRobin;
  for (std::size_t place = 0; place < kPortCount; ++place) {
    for (std::size_t requests = 1; requests < kMasks; ++requests) {
      std::size_t step = 0;
      while ((requests & mask_of(config.priority[(place + step) % kPortCount])) == 0) ++step;
      Winner& winner = winners_[place * kMasks + requests];
      winner.port = mask_of(config.priority[(place + step) % kPortCount]);
      winner.next_place = rotates
                              ? static_cast<std::uint8_t>((place_of(config, winner.port) + 1) % kPortCount)
                              : std::uint8_t{0};
    }
  }
}

void BankArbiter::count_alone(PortMask port, bool write, std::uint64_t cycles) {
  if (cycles == 0) return;
  const std::size_t situation = place_ * kMasks + port;
  if (counting_) {
    outcomes_[outcome_of(situation, write ? kWrite : kRead)] += cycles;
    // Wherever they lay: what remains up to the next call was idle.
    next_uncounted_cycle_ += cycles;
  } else {
    uncounted_accesses_ += cycles;
  }
}

void BankArbiter::skip_to(std::uint32_t state, std::uint64_t cycle, std::uint64_t cycles) {
  static_assert(kTurnaroundRule.max < 0xff);
  place_ = state & 0xffU;
  ready_cycle_ = {cycle + (state >> 8U & 0xffU), cycle + (state >> 16U)};
  if (!counting_) return;
  next_uncounted_cycle_ += cycles;
  idle_cycles_ += cycles;
}

void BankArbiter::count_skipped(Outcome outcome, std::uint64_t cycles) {
  if (counting_) {
    outcomes_[outcome] += cycles;
    idle_cycles_ -= cycles;
  } else if (outcome % kKinds != kTurning) {
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
  for (std::size_t place = 0; place < kPortCount; ++place) {
    for (std::size_t requests = 1; requests < kMasks; ++requests) {
      const std::size_t situation = place * kMasks + requests;
      const std::uint64_t* const outcomes = outcomes_.data() + outcome_of(situation, kRead);
      const std::uint64_t granted = outcomes[kRead] + outcomes[kWrite];
      const PortMask winner = winners_[situation].port;
      stats.reads += outcomes[kRead];
      stats.writes += outcomes[kWrite];
      stats.turnaround_cycles += outcomes[kTurning];
      if ((requests & (requests - 1)) != 0) stats.contended_cycles += granted + outcomes[kTurning];
      const auto winner_index = static_cast<std::size_t>(__builtin_ctz(winner));
      stats.grants[winner_index] += granted;
      for (std::size_t port = 0; port < kPortCount; ++port) {
        if ((requests >> port & 1U) == 0) continue;
        stats.blame[port][ArbiterStats::kTurnaround] += outcomes[kTurning];
        if (port != winner_index) stats.blame[port][winner_index] += granted;
      }
    }
  }
  return stats;
}

}  // namespace stereotlm::memory
