#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "models/memory/arbitration_policies.h"
#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// The statistics of one arbiter. Each stall cycle of a port is blamed on the port that was granted in it, or
// on the turnaround.
struct ArbiterStats {
  static constexpr std::size_t kTurnaround = kMostPorts;  // column of `blame`

  std::uint64_t reads = 0;              // cycles with a read granted
  std::uint64_t writes = 0;             // cycles with a write granted
  std::uint64_t turnaround_cycles = 0;  // cycles in which no port was granted because of turnaround
  std::uint64_t idle_cycles = 0;        // cycles without request
  std::uint64_t busy_cycles = 0;        // cycles with one or more accesses granted
  std::uint64_t contended_cycles = 0;   // cycles with two or more requests for one port of the bank
  std::array<std::uint64_t, kMostPorts> grants{};  // [port]
  std::array<std::array<std::uint64_t, kMostPorts + 1>, kMostPorts>
      blame{};  // [stalled port][port granted, or kTurnaround]: stall cycles
};

// Decides in each cycle which port may access one bank (contract section 2). The policy chooses the winner
// first. If the bank is still turning round for the winner's direction, no port is granted. A bank with
// separate ports grants one read and one write in a cycle: each direction has a state of the policy, and only
// requests of the same direction compete. Plain C++, no SystemC: the single description of arbitration, used
// at every fidelity.
class BankArbiter {
 public:
  // What happened in one cycle, as a number: the requests, the port that was granted or the turnaround, and
  // the direction. Does not depend on the policy. For a bank with separate ports the lower half describes the
  // reads and the upper half the writes. For any other bank the upper half is kNothing.
  using Outcome = std::uint32_t;

  // Takes kind and turnaround of the bank. Throws std::invalid_argument if one of the configurations has
  // problems.
  BankArbiter(const ArbiterConfig& config, const SsramBankConfig& bank);

  // Decides one cycle with at least one request. Throws std::invalid_argument if one of the ports
  // 0 .. kMostPorts - 1 requests that is not in the priority list. `writes`: the ports that would write.
  // `cycle` must increase from call to call; a cycle that is left out has no request. The caller passes the
  // outcomes to count(), in the order of the cycles.
  Outcome decide(std::uint64_t cycle, PortMask requests, PortMask writes) {
    return has_separate_ports_ ? decide_each_direction(cycle, requests, writes)
                               : decide_at(positions_[0], cycle, requests, writes) | kNothing << kHalf;
  }
  // The ports that were granted: at most one, with separate ports at most one in each direction; none if the
  // bank was turning round.
  static PortMask granted_in(Outcome outcome) {
    return static_cast<PortMask>(granted_in_half(outcome & kHalfMask) | granted_in_half(outcome >> kHalf));
  }
  // Calls visit(port, by) for each port that was refused: `by` is the port that was granted in its direction,
  // or ArbiterStats::kTurnaround.
  template <class Visit>
  static void visit_stalls(Outcome outcome, const Visit& visit) {
    for (const Outcome half : {outcome & kHalfMask, outcome >> kHalf}) {
      const std::size_t by = half >> (kMostPorts + 1);
      for (Outcome ports = half & (kMasks - 1); ports != 0; ports &= ports - 1) {
        const Port port = lowest_port(static_cast<PortMask>(ports));
        if (port != by) visit(port, by);
      }
    }
  }
  // Counts `cycles` cycles with this outcome, of which `cycle` is the first.
  void count(std::uint64_t cycle, Outcome outcome, std::uint64_t cycles = 1) {
    if (counting_) {
      idle_cycles_ += cycle - next_uncounted_cycle_;
      next_uncounted_cycle_ = cycle + cycles;
      add(outcome, cycles);
    } else {
      add_uncounted(outcome, cycles);
    }
  }
  // Counts `cycles` cycles in which this port alone requested and was granted. They lie after the last call.
  // Only for a bank without turnaround.
  void count_alone(PortMask port, bool write, std::uint64_t cycles);
  // Moves the policy's state by the grants that count_alone() has counted, at least one.
  void grant_alone(PortMask port, bool write);

  // The state that determines the decisions from `cycle` on: the policy's state in the lower 32 bits, then 16
  // bits each for the cycles until a read and until a write can be granted. For a bank with separate ports:
  // the policy's state for reads in the lower 32 bits, and its state for writes in the upper 32 bits.
  std::uint64_t state(std::uint64_t cycle) const;
  // Skips the `cycles` cycles before `cycle`, which are counted by stats(). After them the state is `state`.
  // count_skipped() counts the outcomes of skipped cycles.
  void skip_to(std::uint64_t state, std::uint64_t cycle, std::uint64_t cycles);
  void count_skipped(Outcome outcome, std::uint64_t cycles) {
    add(outcome, cycles);
    idle_cycles_ -= cycles;
  }

  // stats() counts only the cycles from `first_cycle` up to `end_cycle`, `end_cycle` not included. In all
  // other cycles only the accesses are counted, in uncounted_accesses().
  void begin_counting(std::uint64_t first_cycle);
  void end_counting(std::uint64_t end_cycle);

  bool needs_turnaround() const { return other_direction_cycles_ > 1; }
  bool separates_directions() const { return has_separate_ports_; }
  ArbiterStats stats() const;
  std::uint64_t uncounted_accesses() const { return uncounted_accesses_; }

 private:
  static constexpr std::size_t kMasks = std::size_t{1} << kMostPorts;

  // The memo of the policy: one row for each state that was reached. Rows are never moved or removed.
  struct Row;
  struct Decision {
    Row* if_granted = nullptr;  // the next state if the winner is granted
    Row* if_refused = nullptr;  // the next state if the bank is turning round
    std::size_t winner = 0;     // index of the port

    bool is_known() const { return if_granted != nullptr; }
  };
  struct Row {
    ArbitrationPolicy::State state = 0;
    Row* after_idle = nullptr;               // the next state after a cycle without request
    std::array<Decision, kMasks> decisions;  // [mask of requests]; see decision_of()
  };
  // A state of the policy.
  struct PolicyPosition {
    Row* row;                      // row of the state in next_cycle
    std::uint64_t next_cycle = 0;  // first cycle that is not decided

    // The row of the state in `cycle`, after cycles without request since next_cycle.
    Row& at(std::uint64_t cycle) const {
      Row* reached = row;
      for (std::uint64_t idle = cycle - next_cycle; idle > 0 && reached->after_idle != reached; --idle)
        reached = reached->after_idle;
      return *reached;
    }
  };

  // Half of an outcome. `by`: index of the port that was granted, or ArbiterStats::kTurnaround. `write`: 1
  // for a write.
  static constexpr Outcome outcome_of(std::size_t requests, std::size_t by, std::size_t write) {
    return static_cast<Outcome>((by << 1U | write) << kMostPorts | requests);
  }
  static constexpr unsigned kHalf = 16;  // bits
  static constexpr Outcome kHalfMask = (1U << kHalf) - 1;
  // Half of an outcome without request.
  static constexpr Outcome kNothing = static_cast<Outcome>(ArbiterStats::kTurnaround << (kMostPorts + 1));
  static constexpr PortMask granted_in_half(Outcome half) {
    return static_cast<PortMask>(1U << (half >> (kMostPorts + 1)) & (kMasks - 1));
  }

  Outcome decide_at(PolicyPosition& position, std::uint64_t cycle, PortMask requests, PortMask writes) {
    const bool is_idle_over = cycle == position.next_cycle || position.row->after_idle == position.row;
    const Decision& decision = position.row->decisions[requests];
    if (!is_idle_over || !decision.is_known()) return prepare_and_decide(position, cycle, requests, writes);
    position.next_cycle = cycle + 1;
    const std::size_t write = writes >> decision.winner & 1U;
    if (cycle < ready_cycle_[write]) {
      position.row = decision.if_refused;
      return outcome_of(requests, ArbiterStats::kTurnaround, 0);
    }
    position.row = decision.if_granted;
    ready_cycle_[1 - write] = cycle + other_direction_cycles_;
    return outcome_of(requests, decision.winner, write);
  }
  Outcome prepare_and_decide(PolicyPosition& position, std::uint64_t cycle, PortMask requests,
                             PortMask writes);
  Outcome decide_each_direction(std::uint64_t cycle, PortMask requests, PortMask writes);
  PolicyPosition& position_of(bool write) { return positions_[has_separate_ports_ && write ? 1 : 0]; }
  void add(Outcome outcome, std::uint64_t cycles) {
    outcomes_[outcome & kHalfMask] += cycles;
    if (has_separate_ports_) add_writes(outcome, cycles);
  }
  void add_writes(Outcome outcome, std::uint64_t cycles);
  void add_uncounted(Outcome outcome, std::uint64_t cycles) {
    uncounted_accesses_ += static_cast<unsigned>(__builtin_popcount(granted_in(outcome))) * cycles;
  }

  // Returns the row of a state, which is added if there is none.
  Row& row_of(ArbitrationPolicy::State state);
  const Decision& decision_of(Row& row, PortMask requests);

  const ArbitrationPolicy* policy_;
  PriorityList list_;
  std::unordered_map<ArbitrationPolicy::State, Row> rows_;
  bool has_separate_ports_;
  // Of [0] reads, [1] writes. Without separate ports [0] is of both.
  std::array<PolicyPosition, 2> positions_;
  std::uint64_t other_direction_cycles_;  // from an access to the first possible one in the other direction
  std::array<std::uint64_t, 2> ready_cycle_{};  // first cycle in which [0] a read, [1] a write can be granted
  bool counting_ = false;
  std::uint64_t next_uncounted_cycle_ = 0;  // all counted cycles before it are in the statistics
  std::uint64_t idle_cycles_ = 0;
  // [half of an outcome]: cycles counted. stats() is computed from this table, from idle_cycles_, and from
  // the cycles that are in the table twice, because both halves of their outcome have a grant or contend.
  std::array<std::uint64_t, (kMostPorts + 1) * 2 * kMasks> outcomes_{};
  std::uint64_t both_granted_cycles_ = 0;
  std::uint64_t both_contended_cycles_ = 0;
  std::uint64_t uncounted_accesses_ = 0;
};

}  // namespace stereotlm::memory
