#include "models/fpga/fast/transition_cache.h"

#include <algorithm>
#include <utility>

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

void TransitionCache::clear(std::size_t words) {
  words_ = words;
  key_.resize(1 + words);
  states_.clear();
  masks_.clear();
  state_numbers_.clear();
  effects_.clear();
  effect_numbers_.clear();
  bank_uses_.clear();
  effects_followed_.clear();
  transitions_ = 0;
  mask_ = kFirstBuckets - 1;
  buckets_.assign(kFirstBuckets * words_of_bucket(), 0);
}

std::uint32_t TransitionCache::number_of_effect(const Effect& effect,
                                                const memory::Arbitration& arbitration) {
  const auto [entry, is_new] =
      effect_numbers_.try_emplace(effect, static_cast<std::uint32_t>(effects_.size()));
  if (is_new) {
    effects_.push_back({effect.progress, effect.host, 0, &entry->first});
    bank_uses_.push_back(arbitration.bank_uses(effect.arbitration));
  }
  return entry->second;
}

void TransitionCache::set_key(StateNumber from, const Surroundings& around, HostRequests host) const {
  key_[0] = std::uint64_t{host.first} << 48U | std::uint64_t{host.words} << 32U |
            std::uint64_t{host.route} << 24U | (from + 1);
  const std::uint64_t* const mask = masks_.data() + from * words_;
  for (std::size_t word = 0; word < words_; ++word) key_[1 + word] = around[word] & mask[word];
}

bool TransitionCache::has_key(std::size_t bucket) const {
  const std::uint64_t* const words = buckets_.data() + bucket;
  std::uint64_t difference = 0;
  for (std::size_t word = 0; word < key_.size(); ++word) difference |= words[word] ^ key_[word];
  return difference == 0;
}

// Returns the first word of the bucket of key_, or of the free bucket where it belongs.
std::size_t TransitionCache::bucket_of_key() const {
  Hash hash;
  for (const std::uint64_t word : key_) hash.mix(word);
  for (std::size_t number = hash.value();; ++number) {
    const std::size_t bucket = (number & mask_) * words_of_bucket();
    if (buckets_[bucket] == 0 || has_key(bucket)) return bucket;
  }
}

std::optional<TransitionCache::Transition> TransitionCache::find(StateNumber from, const Surroundings& around,
                                                                 HostRequests host) const {
  set_key(from, around, host);
  const std::size_t bucket = bucket_of_key();
  if (buckets_[bucket] == 0) return std::nullopt;
  const std::uint64_t transition = buckets_[bucket + key_.size()];
  return Transition{static_cast<StateNumber>(transition), static_cast<std::uint32_t>(transition >> 32U)};
}

void TransitionCache::record(StateNumber from, const Surroundings& around, HostRequests host,
                             StateNumber next, const Effect& effect, const memory::Arbitration& arbitration) {
  if (2 * (transitions_ + 1) > mask_) double_buckets();
  set_key(from, around, host);
  std::uint64_t* const words = buckets_.data() + bucket_of_key();
  if (words[0] == 0) ++transitions_;
  std::copy(key_.begin(), key_.end(), words);
  words[key_.size()] = std::uint64_t{number_of_effect(effect, arbitration)} << 32U | next;
}

void TransitionCache::double_buckets() {
  std::vector<std::uint64_t> old(2 * buckets_.size(), 0);
  old.swap(buckets_);
  mask_ = 2 * mask_ + 1;
  for (std::size_t bucket = 0; bucket < old.size(); bucket += words_of_bucket()) {
    if (old[bucket] == 0) continue;
    const auto first = old.begin() + static_cast<std::ptrdiff_t>(bucket);
    std::copy_n(first, key_.size(), key_.begin());
    const std::size_t to = bucket_of_key();
    std::copy_n(first, words_of_bucket(), buckets_.begin() + static_cast<std::ptrdiff_t>(to));
  }
}

void TransitionCache::count_followed(CoreControl& control, memory::Arbitration& arbitration) {
  for (const std::uint32_t number : effects_followed_) {
    const Effect& effect = *effects_[number].effect;
    const std::uint64_t times = std::exchange(effects_[number].followed, 0);
    control.add(effect.counts, times);
    control.count_host(false, (effect.host.requests - effect.host.words) * times);
    control.count_host(true, effect.host.words * times);
    arbitration.count_skipped(effect.arbitration, times);
  }
  effects_followed_.clear();
}

}  // namespace stereotlm::fpga
