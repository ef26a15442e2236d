#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "models/fpga/core_control.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// The progress of the core over some cycles of a frame.
struct Progress {
  std::uint64_t cycles = 0;
  std::uint64_t consumed = 0;  // consume-cycles of the matcher
  std::uint64_t words = 0;     // results written

  void add(const Progress& other, std::uint64_t times = 1) {
    cycles += other.cycles * times;
    consumed += other.consumed * times;
    words += other.words * times;
  }
  Progress since(const Progress& before) const {
    return {cycles - before.cycles, consumed - before.consumed, words - before.words};
  }

  friend bool operator==(const Progress& a, const Progress& b) {
    return a.cycles == b.cycles && a.consumed == b.consumed && a.words == b.words;
  }
};

// The requests of the host from a state on: `words` words one after the other, the first after `first`
// cycles, each other in the cycle after a grant.
struct HostRequests {
  static constexpr std::uint16_t kEndless = UINT16_MAX;         // more words than the group grants
  static constexpr std::uint64_t kMostCycles = UINT16_MAX - 1;  // `first` is at most this

  std::uint16_t first = 0;
  std::uint16_t words = 0;  // 0: no request
  std::uint8_t route = 0;   // a number for the bank and the direction, at most kMostRoute

  static constexpr std::size_t kMostRoute = 127;
};
// The words that the host was granted in a transition.
struct HostGrants {
  std::uint64_t words = 0;
  std::uint64_t cycles = 0;    // of the transition up to the last grant, its cycle included
  std::uint64_t requests = 0;  // cycles in which the host requested

  friend bool operator==(const HostGrants& a, const HostGrants& b) {
    return a.words == b.words && a.cycles == b.cycles && a.requests == b.requests;
  }
};

// Cache of state transitions for FastForward. A transition leads to the end of a group of four columns of the
// matcher, or to the last grant of a burst of the host in the group. Its cycles, its counts and the next
// state follow from the state before it, the requests of the host, and its surroundings. Its cycles are
// stepped once and recorded; after that they are skipped.
//
// States and effects are few: each is stored once, and has a number. The surroundings in real tables hardly
// repeat: each transition stores its own.
class TransitionCache {
 public:
  // Cap: a frame that never repeats would otherwise fill memory.
  static constexpr std::size_t kMost = std::size_t{1} << 17U;

  using State = memory::StateWords;
  using StateNumber = std::uint32_t;

  // Words that determine a transition beside its state. A cache looks at the first words() of them.
  using Surroundings = std::vector<std::uint64_t>;

  struct Effect {
    Progress progress;
    CoreControl::Counts counts;
    memory::CountChanges arbitration;
    HostGrants host;

    friend bool operator==(const Effect& a, const Effect& b) {
      return a.progress == b.progress && a.counts == b.counts && a.arbitration == b.arbitration &&
             a.host == b.host;
    }
  };
  struct Transition {
    StateNumber next = 0;
    std::uint32_t effect = 0;
  };

  explicit TransitionCache(std::size_t words) { clear(words); }
  TransitionCache(const TransitionCache&) = delete;  // effects are referred to
  TransitionCache& operator=(const TransitionCache&) = delete;

  // `mask`: returns a word for each of Surroundings, with a 0 for each bit that has no effect on a transition
  // from this state.
  template <class Mask>
  StateNumber number_of(const State& state, const Mask& mask) {
    const auto [entry, is_new] = state_numbers_.try_emplace(state, static_cast<StateNumber>(states_.size()));
    if (is_new) {
      states_.push_back(&entry->first);
      const Surroundings words = mask();
      masks_.insert(masks_.end(), words.begin(), words.begin() + static_cast<std::ptrdiff_t>(words_));
    }
    return entry->second;
  }
  const State& state(StateNumber number) const { return *states_[number]; }
  // The transition from this state in these surroundings with these requests of the host, if it is recorded.
  std::optional<Transition> find(StateNumber from, const Surroundings& around, HostRequests host = {}) const;
  // `arbitration`: the one that has counted the effect.
  void record(StateNumber from, const Surroundings& around, HostRequests host, StateNumber next,
              const Effect& effect, const memory::Arbitration& arbitration);
  std::size_t words() const { return words_; }
  // Forgets all, and looks at so many words of Surroundings from now on.
  void clear(std::size_t words);
  bool is_full() const { return transitions_ >= kMost || states_.size() >= kMostStates; }

  const Progress& progress(const Transition& transition) const {
    return effects_[transition.effect].progress;
  }
  const HostGrants& host(const Transition& transition) const { return effects_[transition.effect].host; }
  // What the ports did at their banks in the transition.
  const std::vector<memory::BankUse>& bank_uses(const Transition& transition) const {
    return bank_uses_[transition.effect];
  }
  // Counts a transition as followed.
  void follow(const Transition& transition, std::uint64_t times) {
    std::uint64_t& followed = effects_[transition.effect].followed;
    if (followed == 0) effects_followed_.push_back(transition.effect);
    followed += times;
  }
  // Adds the counts of the transitions that were followed since the last call.
  void count_followed(CoreControl& control, memory::Arbitration& arbitration);

 private:
  struct StateHash {
    std::size_t operator()(const State& state) const;
  };
  struct EffectHash {
    std::size_t operator()(const Effect& effect) const;
  };

  // An effect, with what following it needs in one line of the processor's cache.
  struct alignas(64) Known {
    Progress progress;
    HostGrants host;
    std::uint64_t followed;  // times that are not counted yet
    const Effect* effect;
  };

  static constexpr std::size_t kMostStates = std::size_t{1} << 23U;

  // A bucket of the table holds the words of key_, of which the first is 0 if the bucket is free, then a word
  // with the transition. Buckets with few words are aligned to the lines of the processor's cache.
  std::size_t words_of_bucket() const { return words_ <= 2 ? 4 : words_ + 2; }
  void set_key(StateNumber from, const Surroundings& around, HostRequests host) const;
  bool has_key(std::size_t bucket) const;
  std::size_t bucket_of_key() const;
  std::uint32_t number_of_effect(const Effect& effect, const memory::Arbitration& arbitration);
  void double_buckets();

  std::size_t words_ = 0;  // see words()
  std::unordered_map<State, StateNumber, StateHash> state_numbers_;
  std::vector<const State*> states_;  // [number]
  std::vector<std::uint64_t> masks_;  // words_ for each state: see number_of()
  // Of the look-up that is under way: one word with the state's number plus one and the requests of the host,
  // then the surroundings that have an effect.
  mutable std::vector<std::uint64_t> key_;
  std::unordered_map<Effect, std::uint32_t, EffectHash> effect_numbers_;
  std::vector<Known> effects_;                           // [number]
  std::vector<std::vector<memory::BankUse>> bank_uses_;  // [number of the effect]
  std::vector<std::uint32_t> effects_followed_;
  std::vector<std::uint64_t> buckets_;
  std::size_t mask_ = 0;  // number of buckets - 1; they are a power of two
  std::size_t transitions_ = 0;
};

}  // namespace stereotlm::fpga
