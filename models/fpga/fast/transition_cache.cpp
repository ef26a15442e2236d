#include "models/fpga/fast/transition_cache.h"

#include <algorithm>

#include "models/kernels/pixel_column.h"

namespace stereotlm::fpga {
namespace {

// Mixes words into a hash.
class Hash {
 public:
  void mix(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 0x9e3779b97f4a7c15U;
    hash_ ^= hash_ >> 32U;
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0;
};

constexpr std::size_t kFirstBuckets = 1024;

}  // namespace

std::uint64_t Progress::times_in(const Progress& room) const {
  std::uint64_t times = room.cycles / cycles;
  if (consumed != 0) times = std::min(times, room.consumed / consumed);
  if (left_slots != 0) times = std::min(times, room.left_slots / left_slots);
  if (right_slots != 0) times = std::min(times, room.right_slots / right_slots);
  if (words != 0) times = std::min(times, room.words / words);
  return times;
}

std::size_t TransitionCache::StateHash::operator()(const State& state) const {
  Hash hash;
  for (const std::uint64_t word : state) hash.mix(word);
  return hash.value();
}

std::size_t TransitionCache::EffectHash::operator()(const Effect& effect) const {
  Hash hash;
  const Progress& progress = effect.progress;
  for (const std::uint64_t word :
       {progress.cycles, progress.consumed, progress.left_slots, progress.right_slots, progress.words})
    hash.mix(word);
  for (const PortCycles& port : effect.counts) {
    hash.mix(port.granted() << 32U | port.stalled());
    hash.mix(port.passed() << 32U | port.starved());
  }
  hash.mix(effect.host.words << 48U | effect.host.cycles << 24U | effect.host.requests);
  for (const auto& [place, change] : effect.arbitration) hash.mix(place << 16U | change);
  return hash.value();
}

static_assert(4 * kernels::kMostRows + kLaneFifoRule.max <= 64 * TransitionCache::kMostWordsOfSide,
              "Accesses does not hold the slots of a group");

TransitionCache::TransitionCache(std::size_t slots) : words_(2 * ((slots + 63) / 64)) { clear(); }

void TransitionCache::clear() {
  states_.clear();
  unhandled_.clear();
  state_numbers_.clear();
  effects_.clear();
  effect_numbers_.clear();
  followed_.clear();
  conflicts_.clear();
  effects_followed_.clear();
  transitions_ = 0;
  mask_ = kFirstBuckets - 1;
  buckets_.assign(kFirstBuckets * words_of_bucket(), 0);
}

TransitionCache::StateNumber TransitionCache::number_of(const State& state,
                                                        const std::array<std::uint64_t, 2>& handled) {
  const auto [entry, is_new] = state_numbers_.try_emplace(state, static_cast<StateNumber>(states_.size()));
  if (is_new) {
    states_.push_back(&entry->first);
    Accesses unhandled;
    unhandled.fill(~std::uint64_t{0});
    for (std::size_t side = 0; side < 2; ++side) {
      std::uint64_t& first_word = unhandled[side * words_of_side()];
      first_word = handled[side] < 64 ? first_word << handled[side] : 0;
    }
    unhandled_.push_back(unhandled);
  }
  return entry->second;
}

std::uint32_t TransitionCache::number_of_effect(const Effect& effect,
                                                const memory::Arbitration& arbitration) {
  const auto [entry, is_new] =
      effect_numbers_.try_emplace(effect, static_cast<std::uint32_t>(effects_.size()));
  if (is_new) {
    effects_.push_back(&entry->first);
    followed_.push_back(0);
    conflicts_.push_back(
        {effect.progress.cycles, effect.host.words, arbitration.stalls_of(effect.arbitration)});
  }
  return entry->second;
}

TransitionCache::Accesses TransitionCache::key_of(StateNumber from, const Accesses& accesses) const {
  const Accesses& unhandled = unhandled_[from];
  Accesses key;
  for (std::size_t word = 0; word < words_; ++word) key[word] = accesses[word] & unhandled[word];
  return key;
}

// Returns the first word of the bucket of this key, or of the free bucket where it belongs.
std::size_t TransitionCache::bucket_of(std::uint64_t first_word, const Accesses& key) const {
  Hash hash;
  hash.mix(first_word);
  for (std::size_t word = 0; word < words_; ++word) hash.mix(key[word]);
  for (std::size_t number = hash.value();; ++number) {
    const std::size_t bucket = (number & mask_) * words_of_bucket();
    const std::uint64_t* const words = buckets_.data() + bucket;
    if (words[0] == 0) return bucket;
    if (words[0] != first_word) continue;
    std::uint64_t difference = 0;
    for (std::size_t word = 0; word < words_; ++word) difference |= words[1 + word] ^ key[word];
    if (difference == 0) return bucket;
  }
}

std::optional<TransitionCache::Transition> TransitionCache::find(StateNumber from, const Accesses& accesses,
                                                                 HostRequests host) const {
  const std::size_t bucket = bucket_of(first_word_of(from, host), key_of(from, accesses));
  if (buckets_[bucket] == 0) return std::nullopt;
  const std::uint64_t transition = buckets_[bucket + 1 + words_];
  return Transition{static_cast<StateNumber>(transition), static_cast<std::uint32_t>(transition >> 32U)};
}

void TransitionCache::record(StateNumber from, const Accesses& accesses, HostRequests host, StateNumber next,
                             const Effect& effect, const memory::Arbitration& arbitration) {
  if (2 * (transitions_ + 1) > mask_) double_buckets();
  const Accesses key = key_of(from, accesses);
  const std::uint64_t first_word = first_word_of(from, host);
  std::uint64_t* const words = buckets_.data() + bucket_of(first_word, key);
  if (words[0] == 0) ++transitions_;
  words[0] = first_word;
  std::copy_n(key.begin(), words_, words + 1);
  words[1 + words_] = std::uint64_t{number_of_effect(effect, arbitration)} << 32U | next;
}

void TransitionCache::double_buckets() {
  std::vector<std::uint64_t> old(2 * buckets_.size(), 0);
  old.swap(buckets_);
  mask_ = 2 * mask_ + 1;
  Accesses key{};
  for (std::size_t bucket = 0; bucket < old.size(); bucket += words_of_bucket()) {
    if (old[bucket] == 0) continue;
    const auto first = old.begin() + static_cast<std::ptrdiff_t>(bucket);
    std::copy_n(first + 1, words_, key.begin());
    const std::size_t to = bucket_of(old[bucket], key);
    std::copy_n(first, words_of_bucket(), buckets_.begin() + static_cast<std::ptrdiff_t>(to));
  }
}

// Loops are found as by Brent (1980): the mark moves to the current state after 1, 2, 4, .. steps, so that a
// loop of any length is found. When the walk returns to the marked state, it repeats the loop as often as
// there is room.
TransitionCache::StateNumber TransitionCache::walk(StateNumber first, const Accesses& accesses,
                                                   Progress& room, Log* log) {
  StateNumber state = first;
  StateNumber mark = state;
  Progress since_mark;
  std::uint64_t steps = 0;
  std::uint64_t mark_after = 1;
  for (auto transition = find(state, accesses); transition && progress(*transition).fits(room);
       transition = find(state, accesses)) {
    if (transition->next == state) {
      const std::uint64_t times = progress(*transition).times_in(room);
      follow(*transition, times, log);
      room.subtract(progress(*transition), times);
      return state;
    }
    follow(*transition, 1, log);
    room.subtract(progress(*transition));
    since_mark.add(progress(*transition));
    state = transition->next;
    ++steps;
    if (state == mark) {
      const std::uint64_t times = since_mark.times_in(room);
      if (times == 0) continue;
      for (std::uint64_t step = 0; step < steps; ++step) {
        transition = find(state, accesses);
        follow(*transition, times, log);
        state = transition->next;
      }
      if (log != nullptr) {
        for (auto entry = log->end() - static_cast<std::ptrdiff_t>(steps); entry != log->end(); ++entry)
          entry->length = static_cast<std::uint32_t>(steps);
      }
      room.subtract(since_mark, times);
    } else if (steps == mark_after) {
      mark = state;
      since_mark = {};
      steps = 0;
      mark_after *= 2;
    }
  }
  return state;
}

void TransitionCache::count_followed(CoreControl& control, memory::Arbitration& arbitration) {
  for (const std::uint32_t number : effects_followed_) {
    control.add(effects_[number]->counts, followed_[number]);
    arbitration.count_skipped(effects_[number]->arbitration, followed_[number]);
    followed_[number] = 0;
  }
  effects_followed_.clear();
}

}  // namespace stereotlm::fpga
