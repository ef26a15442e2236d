#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <sstream>
#include <string>

#include "models/memory/arbitration_policies.h"
#include "models/memory/bank_arbiter.h"
#include "tests/unit/memory/ports.h"

namespace stereotlm::memory {

// One arbiter and its bank, stepped in every cycle from 0 on: the policy itself with time stamps and one
// count per event.
class PlainArbiter {
 public:
  PlainArbiter(const ArbiterConfig& config, const SsramBankConfig& bank)
      : policy_(find_arbitration_policy(config.policy)->make(config.priority)),
        separate_ports_(bank.kind == BankKind::kQdr),
        turnaround_cycles_(static_cast<std::uint64_t>(bank.turnaround_cycles)) {}

  PortMask step(PortMask requests, PortMask writes) {
    const std::uint64_t now = now_++;
    const auto reading = static_cast<PortMask>(requests & ~writes);
    const auto writing = static_cast<PortMask>(requests & writes);
    PortMask granted = 0;
    if (separate_ports_) {
      granted = step_port(states_[0], now, reading, 0);
      granted = static_cast<PortMask>(granted | step_port(states_[1], now, writing, writing));
    } else {
      granted = step_port(states_[0], now, requests, writes);
    }
    if (!counts) return granted;
    const bool contended = separate_ports_ ? several(reading) || several(writing) : several(requests);
    stats.contended_cycles += contended ? 1 : 0;
    stats.busy_cycles += granted != 0 ? 1 : 0;
    stats.idle_cycles += requests == 0 ? 1 : 0;
    return granted;
  }

  bool counts = false;
  ArbiterStats stats;
  std::uint64_t uncounted_accesses = 0;

 private:
  static bool several(PortMask requests) { return (requests & (requests - 1)) != 0; }

  PortMask step_port(ArbitrationPolicy::State& state, std::uint64_t now, PortMask requests, PortMask writes) {
    if (requests == 0) {
      state = policy_->next(state, 0, 0);
      return 0;
    }
    const Port winner = policy_->winner(state, requests);
    const bool write = (writes & mask_of(winner)) != 0;
    const std::optional<std::uint64_t> other = write ? last_read_ : last_write_;
    const bool is_refused = !separate_ports_ && other && now <= *other + turnaround_cycles_;
    const PortMask granted = is_refused ? PortMask{0} : mask_of(winner);
    state = policy_->next(state, requests, granted);
    if (!is_refused) (write ? last_write_ : last_read_) = now;
    if (counts) {
      count(requests, winner, write, is_refused);
    } else {
      uncounted_accesses += is_refused ? 0 : 1;
    }
    return granted;
  }

  void count(PortMask requests, Port winner, bool write, bool is_refused) {
    const std::size_t by = is_refused ? ArbiterStats::kTurnaround : winner;
    for (std::size_t port = 0; port < kPortCount; ++port) {
      if ((requests >> port & 1U) != 0 && port != by) ++stats.blame[port][by];
    }
    if (is_refused) {
      ++stats.turnaround_cycles;
    } else {
      ++stats.grants[by];
      ++(write ? stats.writes : stats.reads);
    }
  }

  std::unique_ptr<const ArbitrationPolicy> policy_;
  bool separate_ports_;
  std::uint64_t turnaround_cycles_;
  std::array<ArbitrationPolicy::State, 2> states_{};  // without separate ports the first alone
  std::uint64_t now_ = 0;
  std::optional<std::uint64_t> last_read_;
  std::optional<std::uint64_t> last_write_;
};

inline std::string text_of(const ArbiterStats& stats, std::uint64_t uncounted_accesses) {
  std::ostringstream text;
  text << "reads " << stats.reads << ", writes " << stats.writes << ", turnaround " << stats.turnaround_cycles
       << ", idle " << stats.idle_cycles << ", busy " << stats.busy_cycles << ", contended "
       << stats.contended_cycles << ", uncounted " << uncounted_accesses << "; grants";
  for (const std::uint64_t grants : stats.grants) text << ' ' << grants;
  text << "; blame";
  for (const auto& row : stats.blame) {
    for (const std::uint64_t cycles : row) text << ' ' << cycles;
  }
  return text.str();
}
inline std::string text_of(const BankArbiter& arbiter) {
  return text_of(arbiter.stats(), arbiter.uncounted_accesses());
}
inline std::string text_of(const PlainArbiter& arbiter) {
  return text_of(arbiter.stats, arbiter.uncounted_accesses);
}

// All that a set of arbiters counted.
template <typename Arbiters>
std::string texts_of(const Arbiters& arbiters) {
  std::string text;
  for (const auto& arbiter : arbiters) text += text_of(arbiter) + '\n';
  return text;
}

}  // namespace stereotlm::memory
