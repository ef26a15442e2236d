#pragma once

#include <array>
#include <cstdint>

#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// One bit per port, bit index_of(port).
using PortMask = std::uint8_t;
constexpr PortMask mask_of(Port port) { return static_cast<PortMask>(1U << index_of(port)); }

// What one arbiter counted. The blame of a stalled port goes to the port that was granted, or to the
// turnaround.
struct ArbiterStats {
  static constexpr std::size_t kTurnaround = kPortCount;  // column of `blame`

  std::uint64_t reads = 0;              // cycles with a read granted
  std::uint64_t writes = 0;             // cycles with a write granted
  std::uint64_t turnaround_cycles = 0;  // cycles in which the winner was refused
  std::uint64_t idle_cycles = 0;        // cycles without request
  std::uint64_t contended_cycles = 0;   // cycles with two or more requests
  std::array<std::uint64_t, kPortCount> grants{};
  std::array<std::array<std::uint64_t, kPortCount + 1>, kPortCount> blame{};  // [victim][by]
};

// Decides each cycle which port may access one bank (contract section 2). The winner is chosen first; if the
// bank is still turning round for the winner's direction nobody is granted, and the round-robin place does
// not move. Plain C++, no SystemC: the single description of arbitration, whatever steps it.
class BankArbiter {
 public:
  // What happened in a cycle: who asked, in which round-robin place, and what came of it.
  using Outcome = std::uint16_t;

  // `turnaround_cycles`: 0 for a bank that needs none.
  BankArbiter(const ArbiterConfig& config, int turnaround_cycles);

  // One cycle with at least one request: `requests`, and of these the writes. Cycles must increase. What it
  // returns is to be counted, in the order of the cycles.
  Outcome decide(std::uint64_t cycle, PortMask requests, PortMask writes) {
    const std::size_t situation = place_ * kMasks + requests;
    const Winner winner = winners_[situation];
    const bool write = (writes & winner.port) != 0;
    if (cycle < ready_cycle_[std::size_t{write}]) return outcome_of(situation, kTurning);
    place_ = winner.next_place;
    ready_cycle_[std::size_t{!write}] = cycle + other_direction_cycles_;
    return outcome_of(situation, write ? kWrite : kRead);
  }
  // The port that was granted as a mask of one bit, 0 if the bank was turning round.
  PortMask granted_in(Outcome outcome) const {
    return outcome % kKinds == kTurning ? PortMask{0} : winners_[outcome / kKinds].port;
  }
  // The outcome of this cycle, and of all of `cycles` from it on.
  void count(std::uint64_t cycle, Outcome outcome, std::uint64_t cycles = 1) {
    if (counting_) {
      idle_cycles_ += cycle - next_uncounted_cycle_;
      next_uncounted_cycle_ = cycle + cycles;
      outcomes_[outcome] += cycles;
    } else if (outcome % kKinds != kTurning) {
      uncounted_accesses_ += cycles;
    }
  }
  // Counts `cycles` cycles since the last call, in each of which this port alone asked and was granted, for a
  // bank that needs no turnaround ..
  void count_alone(PortMask port, bool write, std::uint64_t cycles);
  // .. and, where these are at least one, what they do to the round-robin place.
  void move_place_behind(PortMask port) { place_ = winners_[place_ * kMasks + port].next_place; }

  // All that the decisions from `cycle` on depend on.
  std::uint32_t state(std::uint64_t cycle) const {
    const auto wait = [cycle](std::uint64_t ready) {
      return static_cast<std::uint32_t>(ready > cycle ? ready - cycle : 0);
    };
    return static_cast<std::uint32_t>(place_) | wait(ready_cycle_[0]) << 8U | wait(ready_cycle_[1]) << 16U;
  }
  // As if the last of the cycles decided lay so many cycles later, and the decisions in between, counted by
  // count_skipped(), led to this state from `cycle` on.
  void skip_to(std::uint32_t state, std::uint64_t cycle, std::uint64_t cycles);
  void count_skipped(Outcome outcome, std::uint64_t cycles);

  // Only the cycles from `first_cycle` on, up to but not including `end_cycle`, are counted in stats(); of
  // the others only the accesses, in uncounted_accesses().
  void begin_counting(std::uint64_t first_cycle);
  void end_counting(std::uint64_t end_cycle);

  bool needs_turnaround() const { return other_direction_cycles_ > 1; }
  ArbiterStats stats() const;
  std::uint64_t uncounted_accesses() const { return uncounted_accesses_; }

 private:
  enum Kind : std::size_t { kRead, kWrite, kTurning, kKinds = 4 };
  static constexpr std::size_t kMasks = std::size_t{1} << kPortCount;
  struct Winner {
    PortMask port = 0;
    std::uint8_t next_place = 0;
  };
  static constexpr Outcome outcome_of(std::size_t situation, Kind kind) {
    return static_cast<Outcome>(situation * kKinds + kind);
  }

  // A situation is a round-robin place and a mask of requests.
  std::array<Winner, kPortCount * kMasks> winners_{};
  std::size_t place_ = 0;
  std::uint64_t other_direction_cycles_;        // from an access to the first in the other direction
  std::array<std::uint64_t, 2> ready_cycle_{};  // from which a read, a write can be granted
  bool counting_ = false;
  std::uint64_t next_uncounted_cycle_ = 0;  // all counted cycles before it are in the statistics
  std::uint64_t idle_cycles_ = 0;
  // How often each thing happened: with the winners it says all that stats() reports.
  std::array<std::uint64_t, kPortCount * kMasks * kKinds> outcomes_{};
  std::uint64_t uncounted_accesses_ = 0;
};

}  // namespace stereotlm::memory
