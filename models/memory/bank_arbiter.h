#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "models/memory/arbitration_policies.h"
#include "models/memory/memory_config.h"

namespace stereotlm::memory {

// A state as words: equal words mean that the same decisions follow.
using StateWords = std::vector<std::uint64_t>;
// The place in StateWords from which the next part of a state is taken.
using StateReader = StateWords::const_iterator;

// Counters that have changed: the index of each, and by how much.
using CountChanges = std::vector<std::pair<std::uint32_t, std::uint64_t>>;

// The causes of a stall that are no port, behind the numbers of the ports.
inline constexpr std::size_t kTurnaround = kMostPorts;
inline constexpr std::size_t kRow = kMostPorts + 1;      // of sdram: a row is being opened
inline constexpr std::size_t kRefresh = kMostPorts + 2;  // of sdram
inline constexpr std::size_t kOtherCauses = kRefresh + 1 - kMostPorts;
inline constexpr std::size_t kGranted = SIZE_MAX;  // no stall
inline const char* name_of_cause(std::size_t cause) {
  return cause == kTurnaround ? "turnaround" : cause == kRow ? "row" : "refresh";
}

// The statistics of one arbiter, as one row of counters. Each stall cycle of a port is blamed on the port
// that was granted in it, or on a cause that is no port.
class ArbiterStats {
 public:
  // The place of a counter in the row.
  enum Place : std::size_t {
    kReads,
    kWrites,
    kBusy,
    kTurnaroundCycles,
    kRowCycles,
    kRefreshCycles,
    kContended,
    kIdle,
    kUncounted,
    kRowsOpened,
    kRefreshes,
    kUncountedRefreshes,
    kFirstGrants,  // then those of the other ports, then the blame
  };

  // `ports`: of the priority list.
  explicit ArbiterStats(std::size_t ports)
      : ports_(ports), counts_(kFirstGrants + ports * (1 + ports + kOtherCauses)) {}

  std::uint64_t reads() const { return counts_[kReads]; }       // cycles with a read granted
  std::uint64_t writes() const { return counts_[kWrites]; }     // cycles with a write granted
  std::uint64_t busy_cycles() const { return counts_[kBusy]; }  // cycles with one or more accesses granted
  // Cycles in which no port was granted because of turnaround.
  std::uint64_t turnaround_cycles() const { return counts_[kTurnaroundCycles]; }
  // Of sdram: cycles in which a row was being opened, and in which the bank was refreshed.
  std::uint64_t row_cycles() const { return counts_[kRowCycles]; }
  std::uint64_t refresh_cycles() const { return counts_[kRefreshCycles]; }
  // Cycles with two or more requests for one port of the bank.
  std::uint64_t contended_cycles() const { return counts_[kContended]; }
  std::uint64_t idle_cycles() const { return counts_[kIdle]; }  // all other cycles
  // Accesses granted in cycles that are not counted.
  std::uint64_t uncounted_accesses() const { return counts_[kUncounted]; }
  // Of sdram, before the last count_rows(): rows opened; refreshes begun in counted cycles, and in others.
  std::uint64_t rows_opened() const { return counts_[kRowsOpened]; }
  std::uint64_t refreshes() const { return counts_[kRefreshes]; }
  std::uint64_t uncounted_refreshes() const { return counts_[kUncountedRefreshes]; }
  std::uint64_t grants(Port port) const { return counts_[grants_place(port)]; }
  // Stall cycles of a port. `by`: the port that was granted in them, or another cause.
  std::uint64_t blame(Port port, std::size_t by) const { return counts_[blame_place(port, by)]; }

  std::size_t grants_place(Port port) const { return kFirstGrants + port; }  // place of the grants of a port
  std::size_t blame_place(Port port, std::size_t by) const {                 // place of the stalls of a port
    const std::size_t cause = by < kMostPorts ? by : ports_ + (by - kMostPorts);
    return kFirstGrants + ports_ + port * (ports_ + kOtherCauses) + cause;
  }
  // The port of a place in the grants, with kGranted, or in the blame, with the cause. Nothing for any other
  // place.
  std::optional<std::pair<Port, std::size_t>> use_at(std::size_t place) const {
    if (place < kFirstGrants) return std::nullopt;
    if (place < kFirstGrants + ports_) return std::pair{place - kFirstGrants, kGranted};
    const std::size_t of_blame = place - kFirstGrants - ports_;
    const std::size_t causes = ports_ + kOtherCauses;
    const std::size_t by = of_blame % causes;
    return std::pair{of_blame / causes, by < ports_ ? by : kMostPorts + (by - ports_)};
  }

  const std::vector<std::uint64_t>& counts() const { return counts_; }             // [place]
  void add(std::size_t place, std::uint64_t change) { counts_[place] += change; }  // changes one counter

 private:
  std::size_t ports_;
  std::vector<std::uint64_t> counts_;  // [place]
};

// Decides in each cycle which port may access one bank (contract section 2). The policy chooses the winner
// first. If the bank is still turning round for the winner's direction, no port is granted. Nor is it while a
// bank of sdram is refreshed, or opens a row (contract 8.3). A bank with
// separate ports grants one read and one write in a cycle: each direction has an order of the policy, and
// only requests of the same direction compete. Plain C++, no SystemC: the single description of arbitration,
// used at every fidelity.
class BankArbiter {
 public:
  // One cycle: the ports that requested, those of them that would write, and those that were granted. At most
  // one is granted, with separate ports at most one in each direction. If none is, there is a cause.
  struct Outcome {
    PortMask requests = 0;            // ports that requested
    PortMask writes = 0;              // those of them that would write
    PortMask granted = 0;             // those of them that were granted
    std::size_t cause = kTurnaround;  // why none was granted; else without meaning
  };

  // Takes kind and turnaround of the bank. Throws std::invalid_argument if one of the configurations has
  // problems.
  BankArbiter(const ArbiterConfig& config, const SsramBankConfig& bank);

  // Decides one cycle. Throws std::invalid_argument unless one or more ports of the priority list request,
  // and no others. `writes`: the ports that would write. `cycle` must increase from call to call; a cycle
  // that is left out has no request. `words`: of sdram, the word that each port requests: [port]. The caller
  // passes the outcomes to count().
  Outcome decide(std::uint64_t cycle, PortMask requests, PortMask writes,
                 const std::uint32_t* words = nullptr);
  // Counts `cycles` cycles with this outcome.
  void count(const Outcome& outcome, std::uint64_t cycles = 1);
  // Counts a change of one counter in cycles that were skipped.
  void count_skipped(std::size_t place, std::uint64_t change) { stats_.add(place, change); }
  // Moves the order of the policy by one or more grants of an uncontended port, which are counted elsewhere.
  void grant_alone(Port port, bool write);

  // The state that determines the decisions from `cycle` on: the orders, and the cycles until a read and
  // until a write can be granted.
  void append_state(std::uint64_t cycle, StateWords& state) const;
  // Takes over the state that determines the decisions from `cycle` on.
  void set_state(std::uint64_t cycle, StateReader& state);

  // stats() counts only the cycles from `first_cycle` up to `end_cycle`, `end_cycle` not included. In all
  // other cycles only the accesses are counted, in ArbiterStats::uncounted_accesses(). end_counting() adds
  // the idle cycles.
  void begin_counting(std::uint64_t first_cycle);
  void end_counting(std::uint64_t end_cycle);
  const ArbiterStats& stats() const { return stats_; }
  // Counts the rows and refreshes of sdram, and their cycles, up to `end_cycle`. Counting must have been on
  // in all of them, or in none.
  void count_rows(std::uint64_t end_cycle);

  // Whether a request without competitors is granted in its cycle.
  bool grants_at_once() const { return !has_turnaround_ && !rows_; }
  bool has_rows() const { return rows_.has_value(); }  // whether the bank is of sdram
  // Of sdram; null for any other bank. Not part of append_state().
  SdramRows* rows() { return rows_ ? &*rows_ : nullptr; }
  const SdramRows* rows() const { return rows_ ? &*rows_ : nullptr; }
  bool separates_directions() const { return has_separate_ports_; }

 private:
  void decide_direction(PriorityList& order, std::uint64_t cycle, PortMask requests,
                        const std::uint32_t* words, Outcome& outcome);
  void count_direction(PortMask requests, PortMask granted, bool write, std::size_t cause,
                       std::uint64_t cycles);
  void advance(PriorityList& order, PortMask requests, PortMask granted) const {
    if (policy_->advance != nullptr) policy_->advance(list_, order, requests, granted);
  }

  const ArbitrationPolicy* policy_;
  PriorityList list_;
  PortMask ports_;  // all of the list
  bool has_separate_ports_;
  bool has_turnaround_;
  // Of [0] reads, [1] writes. Without separate ports [0] is of both.
  std::array<PriorityList, 2> orders_;
  std::uint64_t next_cycle_ = 0;  // the first cycle that is not decided
  // From [0] a read, [1] a write to the first possible access in the other direction.
  std::array<std::uint64_t, 2> other_direction_cycles_;
  std::array<std::uint64_t, 2> ready_cycle_{};  // first cycle in which [0] a read, [1] a write can be granted
  std::optional<SdramRows> rows_;
  bool counting_ = false;
  std::uint64_t first_counted_cycle_ = 0;
  std::uint64_t counted_cycles_ = 0;
  ArbiterStats stats_;
};

}  // namespace stereotlm::memory
