#include "models/fpga/fast/transition_cache.h"

#include <algorithm>

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
  for (const std::uint64_t word : {effect.progress.cycles, effect.progress.consumed, effect.progress.words})
    hash.mix(word);
  for (const PortCycles& port : effect.counts) {
    hash.mix(port.granted() << 32U | port.stalled());
    hash.mix(port.passed() << 32U | port.starved());
  }
  hash.mix(effect.host.words << 48U | effect.host.cycles << 24U | effect.host.requests);
  for (const auto& [place, change] : effect.arbitration) hash.mix(place << 16U | change);
  return hash.value();
}

TransitionCache::TransitionCache(std::size_t words) : words_(words), key_(words) { clear(); }

void TransitionCache::clear() {
  states_.clear();
  plain_.clear();
  last_changes_.clear();
  progress_.clear();
  unhandled_.clear();
  state_numbers_.clear();
  effects_.clear();
  effect_numbers_.clear();
  followed_.clear();
  conflicts_.clear();
  effects_followed_.clear();
  transitions_ = 0;
  plain_transitions_ = 0;
  mask_ = kFirstBuckets - 1;
  buckets_.assign(kFirstBuckets * words_of_bucket(), 0);
}

// The state with other last words, up to the next call.
const TransitionCache::State& TransitionCache::changed(StateNumber number, const State& last_words) {
  changed_ = *states_[number];
  std::copy(last_words.begin(), last_words.end(),
            changed_.end() - static_cast<std::ptrdiff_t>(last_words.size()));
  return changed_;
}

TransitionCache::StateNumber TransitionCache::with_last_words(StateNumber number, const State& last_words) {
  return number_of(changed(number, last_words), [this, number] {
    const auto first = unhandled_.begin() + static_cast<std::ptrdiff_t>(number * words_);
    return Accesses(first, first + static_cast<std::ptrdiff_t>(words_));
  });
}

TransitionCache::StateNumber TransitionCache::with_last_word(StateNumber number, std::uint64_t last_word) {
  if (last_changes_[number].first != last_word) {
    const StateNumber with_word = with_last_words(number, State{last_word});
    last_changes_[number] = {last_word, with_word};
  }
  return last_changes_[number].second;
}

std::optional<TransitionCache::StateNumber> TransitionCache::find_with_last_words(StateNumber number,
                                                                                  const State& last_words) {
  const auto found = state_numbers_.find(changed(number, last_words));
  return found == state_numbers_.end() ? std::nullopt : std::optional(found->second);
}

std::uint32_t TransitionCache::number_of_effect(const Effect& effect,
                                                const memory::Arbitration& arbitration) {
  const auto [entry, is_new] =
      effect_numbers_.try_emplace(effect, static_cast<std::uint32_t>(effects_.size()));
  if (is_new) {
    effects_.push_back(&entry->first);
    progress_.push_back(effect.progress);
    followed_.push_back(0);
    conflicts_.push_back(
        {effect.progress.cycles, effect.host.words, arbitration.stalls_of(effect.arbitration)});
  }
  return entry->second;
}

// Sets key_ to the accesses that matter.
void TransitionCache::set_key(StateNumber from, const Accesses& accesses) const {
  const std::uint64_t* const unhandled = unhandled_.data() + from * words_;
  for (std::size_t word = 0; word < words_; ++word) key_[word] = accesses[word] & unhandled[word];
}

// Returns the first word of the bucket of key_, or of the free bucket where it belongs.
std::size_t TransitionCache::bucket_of(std::uint64_t first_word) const {
  Hash hash;
  hash.mix(first_word);
  for (const std::uint64_t word : key_) hash.mix(word);
  for (std::size_t number = hash.value();; ++number) {
    const std::size_t bucket = (number & mask_) * words_of_bucket();
    const std::uint64_t* const words = buckets_.data() + bucket;
    if (words[0] == 0) return bucket;
    if (words[0] != first_word) continue;
    std::uint64_t difference = 0;
    for (std::size_t word = 0; word < words_; ++word) difference |= words[1 + word] ^ key_[word];
    if (difference == 0) return bucket;
  }
}

std::optional<TransitionCache::Transition> TransitionCache::find(StateNumber from, const Accesses& accesses,
                                                                 HostRequests host) const {
  set_key(from, accesses);
  if (is_plain(host)) return find_plain(from);
  const std::size_t bucket = bucket_of(first_word_of(from, host));
  if (buckets_[bucket] == 0) return std::nullopt;
  return transition_of(buckets_[bucket + 1 + words_]);
}

void TransitionCache::record(StateNumber from, const Accesses& accesses, HostRequests host, StateNumber next,
                             const Effect& effect, const memory::Arbitration& arbitration) {
  if (2 * (transitions_ + 1) > mask_) double_buckets();
  const std::uint64_t transition = std::uint64_t{number_of_effect(effect, arbitration)} << 32U | next;
  set_key(from, accesses);
  if (is_plain(host)) {
    if (plain_[from] == kNone) ++plain_transitions_;
    plain_[from] = transition;
    return;
  }
  const std::uint64_t first_word = first_word_of(from, host);
  std::uint64_t* const words = buckets_.data() + bucket_of(first_word);
  if (words[0] == 0) ++transitions_;
  words[0] = first_word;
  std::copy(key_.begin(), key_.end(), words + 1);
  words[1 + words_] = transition;
}

void TransitionCache::double_buckets() {
  std::vector<std::uint64_t> old(2 * buckets_.size(), 0);
  old.swap(buckets_);
  mask_ = 2 * mask_ + 1;
  for (std::size_t bucket = 0; bucket < old.size(); bucket += words_of_bucket()) {
    if (old[bucket] == 0) continue;
    const auto first = old.begin() + static_cast<std::ptrdiff_t>(bucket);
    std::copy_n(first + 1, words_, key_.begin());
    const std::size_t to = bucket_of(old[bucket]);
    std::copy_n(first, words_of_bucket(), buckets_.begin() + static_cast<std::ptrdiff_t>(to));
  }
}

// Loops are found as by Brent (1980): the mark moves to the current state after 1, 2, 4, .. steps, so that a
// loop of any length is found. When the walk returns to the marked state, it repeats the loop as often as
// there is room.
TransitionCache::StateNumber TransitionCache::walk(StateNumber first, const Accesses& accesses,
                                                   Progress& room, Log* log) {
  const bool is_plain =
      std::all_of(accesses.begin(), accesses.end(), [](std::uint64_t word) { return word == 0; });
  const auto next = [&](StateNumber from) { return is_plain ? find_plain(from) : find(from, accesses); };
  StateNumber state = first;
  StateNumber mark = state;
  Progress since_mark;
  std::uint64_t steps = 0;
  std::uint64_t mark_after = 1;
  for (auto transition = next(state); transition && progress(*transition).fits(room);
       transition = next(state)) {
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
        transition = next(state);
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

void TransitionCache::repeat_loop(std::uint64_t times) {
  followed_before_loop_.resize(followed_.size());
  for (const std::uint32_t number : effects_followed_)
    followed_[number] += (followed_[number] - followed_before_loop_[number]) * times;
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
