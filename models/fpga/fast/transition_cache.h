#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "models/fpga/core_control.h"
#include "models/fpga/record/conflict_recorder.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// The progress of the core over some cycles of a frame, or a limit for that progress.
struct Progress {
  std::uint64_t cycles = 0;
  std::uint64_t consumed = 0;  // consume-cycles of the matcher
  std::uint64_t words = 0;     // results written

  bool fits(const Progress& room) const {
    return cycles <= room.cycles && consumed <= room.consumed && words <= room.words;
  }
  // How many times this progress fits into the limit `room`. `cycles` must not be 0.
  std::uint64_t times_in(const Progress& room) const;
  void add(const Progress& other, std::uint64_t times = 1) {
    cycles += other.cycles * times;
    consumed += other.consumed * times;
    words += other.words * times;
  }
  void subtract(const Progress& other, std::uint64_t times = 1) {
    cycles -= other.cycles * times;
    consumed -= other.consumed * times;
    words -= other.words * times;
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
// state follow from the state before it, the requests of the host, and the accesses of the slots that the
// group can handle. Its cycles are stepped once and recorded; after that they are skipped.
//
// States and Effects are few: each is stored once, and has a number. The accesses of real tables hardly
// repeat: each transition stores its own.
class TransitionCache {
 public:
  // Cap: a frame that never repeats would otherwise fill memory.
  static constexpr std::size_t kMost = std::size_t{1} << 17U;

  using State = memory::StateWords;
  using StateNumber = std::uint32_t;

  // A bit for each slot that can be in a lane before the end of the group, in the order of the slots: 1 if
  // the slot accesses its pixel. Half of the words are for the left side. The bits of slots that are handled
  // before the transition have no effect. All objects of a cache have the same number of words.
  using Accesses = std::vector<std::uint64_t>;

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
  struct StateHash {
    std::size_t operator()(const State& state) const;
  };
  struct Transition {
    StateNumber next = 0;
    std::uint32_t effect = 0;
  };
  // Transitions in the order in which they were followed, for a recorder. This entry and the `length` - 1
  // behind it are a loop, which was followed `times` times.
  struct Followed {
    std::uint32_t effect;
    std::uint32_t length;
    std::uint64_t times;
  };
  using Log = std::vector<Followed>;

  // `words`: of Accesses.
  explicit TransitionCache(std::size_t words);
  TransitionCache(const TransitionCache&) = delete;  // effects are referred to
  TransitionCache& operator=(const TransitionCache&) = delete;

  // `unhandled`: returns Accesses with a 0 for each slot that is handled before a transition from this state.
  template <class Unhandled>
  StateNumber number_of(const State& state, const Unhandled& unhandled) {
    const auto [entry, is_new] = state_numbers_.try_emplace(state, static_cast<StateNumber>(states_.size()));
    if (is_new) {
      states_.push_back(&entry->first);
      plain_.push_back(kNone);
      last_changes_.push_back({entry->first.back(), entry->second});
      const Accesses mask = unhandled();
      unhandled_.insert(unhandled_.end(), mask.begin(), mask.end());
    }
    return entry->second;
  }
  // The number of a state that differs from this one in the last words only. The second one adds no state.
  StateNumber with_last_words(StateNumber number, const State& last_words);
  std::optional<StateNumber> find_with_last_words(StateNumber number, const State& last_words);
  StateNumber with_last_word(StateNumber number, std::uint64_t last_word);
  const State& state(StateNumber number) const { return *states_[number]; }
  // The transition from this state with these accesses and requests of the host, if it is recorded.
  std::optional<Transition> find(StateNumber from, const Accesses& accesses, HostRequests host = {}) const;
  // `arbitration`: the one that has counted the effect.
  void record(StateNumber from, const Accesses& accesses, HostRequests host, StateNumber next,
              const Effect& effect, const memory::Arbitration& arbitration);
  void clear();
  bool is_full() const { return transitions_ + plain_transitions_ >= kMost || states_.size() >= kMostStates; }

  const Progress& progress(std::uint32_t effect) const { return progress_[effect]; }
  const Progress& progress(const Transition& transition) const { return progress(transition.effect); }
  const HostGrants& host(const Transition& transition) const { return effects_[transition.effect]->host; }
  const GroupConflicts& conflicts(std::uint32_t effect) const { return conflicts_[effect]; }
  // Counts a transition as followed. Adds it to `log`, unless that is null.
  void follow(const Transition& transition, std::uint64_t times = 1, Log* log = nullptr) {
    if (log != nullptr) log->push_back({transition.effect, 1, times});
    std::uint64_t& followed = followed_[transition.effect];
    if (followed == 0) effects_followed_.push_back(transition.effect);
    followed += times;
  }
  // The same for a transition of a whole group. If it equals the last one of `log`, both become one entry.
  void follow_group(const Transition& transition, Log* log) {
    const bool comes_again =
        log != nullptr && !log->empty() && log->back().effect == transition.effect && log->back().length == 1;
    if (comes_again) ++log->back().times;
    follow(transition, 1, comes_again ? nullptr : log);
  }
  // Follows recorded transitions with these accesses as far as `room` allows, and reduces `room`. A loop of
  // transitions is repeated in one step. Adds them to `log`, unless that is null. Returns the next state.
  StateNumber walk(StateNumber first, const Accesses& accesses, Progress& room, Log* log = nullptr);
  // Repeats all transitions that were followed since begin_loop(). Between the two nothing was counted.
  void begin_loop() { followed_before_loop_ = followed_; }
  void repeat_loop(std::uint64_t times);
  // Adds the counts of the transitions that were followed since the last call.
  void count_followed(CoreControl& control, memory::Arbitration& arbitration);

 private:
  struct EffectHash {
    std::size_t operator()(const Effect& effect) const;
  };

  static constexpr std::size_t kMostStates = std::size_t{1} << 23U;
  static constexpr std::uint64_t kNone = UINT64_MAX;

  static Transition transition_of(std::uint64_t word) {
    return {static_cast<StateNumber>(word), static_cast<std::uint32_t>(word >> 32U)};
  }
  // Whether the key set last is without accesses, for a host that requests nothing.
  bool is_plain(HostRequests host) const {
    return host.words == 0 &&
           std::all_of(key_.begin(), key_.end(), [](std::uint64_t word) { return word == 0; });
  }
  std::optional<Transition> find_plain(StateNumber from) const {
    return plain_[from] == kNone ? std::nullopt : std::optional(transition_of(plain_[from]));
  }

  // A bucket of the table: one word with the state's number plus one (0: the bucket is free) and the requests
  // of the host, the accesses of key_, one word with the transition.
  std::size_t words_of_bucket() const { return words_ + 2; }
  const State& changed(StateNumber number, const State& last_words);
  void set_key(StateNumber from, const Accesses& accesses) const;
  static std::uint64_t first_word_of(StateNumber from, HostRequests host) {
    return std::uint64_t{host.first} << 48U | std::uint64_t{host.words} << 32U |
           std::uint64_t{host.route} << 24U | (from + 1);
  }
  std::size_t bucket_of(std::uint64_t first_word) const;
  std::uint32_t number_of_effect(const Effect& effect, const memory::Arbitration& arbitration);
  void double_buckets();

  std::size_t words_;  // of the accesses
  std::unordered_map<State, StateNumber, StateHash> state_numbers_;
  std::vector<const State*> states_;  // [number]
  State changed_;                     // of changed()
  // [number]: the transition from it without accesses and without requests of the host, as the last word of a
  // bucket, or kNone. They are not in the table: of regular frames there are no others.
  std::vector<std::uint64_t> plain_;
  // [number]: the last call of with_last_word(), its word and its result.
  std::vector<std::pair<std::uint64_t, StateNumber>> last_changes_;
  std::vector<std::uint64_t> unhandled_;  // words_ for each state: see number_of()
  mutable Accesses key_;                  // of the look-up that is under way
  std::unordered_map<Effect, std::uint32_t, EffectHash> effect_numbers_;
  std::vector<const Effect*> effects_;   // [number]
  std::vector<Progress> progress_;       // [number]: a copy that lies together
  std::vector<std::uint64_t> followed_;  // [number of the effect]: times not counted yet
  std::vector<std::uint32_t> effects_followed_;
  std::vector<std::uint64_t> followed_before_loop_;
  std::vector<GroupConflicts> conflicts_;  // [number of the effect]
  std::vector<std::uint64_t> buckets_;
  std::size_t mask_ = 0;         // number of buckets - 1; they are a power of two
  std::size_t transitions_ = 0;  // in the table
  std::size_t plain_transitions_ = 0;
};

}  // namespace stereotlm::fpga
