#pragma once

#include "models/kernels/simd_vectors.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {

// A Key is the score of a candidate, with as much of its disparity as fits. Best is the best key of several
// groups of disparities.

// The largest window sums that fit into NarrowKeys and into WideKeys.
constexpr int kLargestNarrowSum = 16383;
constexpr int kLargestWideSum = 0x7FFEFE;

// NarrowKeys have 16 bits. The smallest key is the best: a key is sum * 4 + disparity % 4 - 32768. The first
// disparity of the group of 4 is kept beside the best key.
struct NarrowKeys {
  static constexpr int kGroup = 4;
  static constexpr int kScale = 4;
  using Key = Int16s;
  struct Best {
    Int16s key;
    Int16s group;
  };

  static Key without_sum(int disparity) { return int16s(-32768 + disparity % kGroup); }
  static void add(Key& key, Int16s column_sum) { key += column_sum; }
  static Key none() { return int16s(32767); }
  static Key best_of(Key a, Key b) { return smaller(a, b); }
  // Returns none() in the lanes in which `outside` is the largest value. In all others it is the smallest.
  static Key unless(Int16s outside, Key key) { return larger(key, outside); }
  static Best best_of_none() { return {none(), Int16s{}}; }
  // The smaller sum wins. Of equal sums `best` wins, whose disparity is smaller.
  static Best better(const Best& best, const Best& other) {
    const Int16s key = in_register(best.key);
    const auto smaller_sum = (key & -kGroup) > other.key;
    return {smaller_sum ? other.key : key, smaller_sum ? other.group : best.group};
  }
  static Best better(const Best& best, Key key, int group) { return better(best, {key, int16s(group)}); }
  // Loads the best keys, each from the lane before; none() in the lanes in which `outside` is the largest
  // value.
  static Best load_moved(const Best* best, Int16s outside) {
    const auto* lanes = reinterpret_cast<const std::int16_t*>(best);
    return {unless(outside, load<Int16s>(lanes - 1)), load<Int16s>(lanes + kLanes - 1)};
  }
  static Int16s disparity(const Best& best) { return best.group + (best.key & (kGroup - 1)); }
};

// WideKeys have 32 bits, in separate vectors for even and odd lanes. The smallest key is the best: a key is
// sum * 256 + disparity.
struct WideKeys {
  static constexpr int kGroup = 2;
  static constexpr int kScale = 1;       // of column sums of 16 bits
  static constexpr int kSumScale = 256;  // of column sums of 32 bits
  using Key = Int32Pair;
  using Best = Key;

  static Key without_sum(int disparity) { return {int32s(disparity), int32s(disparity)}; }
  static void add(Key& key, Int16s column_sum) {
    key.even += even_lanes(column_sum) << 8;
    key.odd += odd_lanes(column_sum) << 8;
  }
  static void add(Key& key, const Int32Pair& column_sum) {
    key.even += column_sum.even;
    key.odd += column_sum.odd;
  }
  static Key none() { return {int32s(0x7FFF0000), int32s(0x7FFF0000)}; }
  static Key best_of(const Key& a, const Key& b) { return {smaller(a.even, b.even), smaller(a.odd, b.odd)}; }
  static Key unless(Int16s outside, const Key& key) {
    return {larger(key.even, even_lanes(outside) << 16), larger(key.odd, odd_lanes(outside) << 16)};
  }
  static Best best_of_none() { return none(); }
  static Best better(const Best& best, const Best& other) { return best_of(best, other); }
  static Best better(const Best& best, const Key& key, int /*group*/) { return best_of(best, key); }
  static Best load_moved(const Best* best, Int16s outside) {
    const auto* lanes = reinterpret_cast<const std::int32_t*>(best);
    return unless(outside, {load<Int32s>(lanes + kLanes / 2 - 1), best->even});
  }
  static Int16s disparity(const Best& best) { return join_lanes(best.even & 0xFF, best.odd & 0xFF); }
};

// WideGroupKeys are for larger sums: a key is sum * 4 + disparity % 2. The first disparity of the group of 2
// is kept beside the best key.
struct WideGroupKeys : WideKeys {
  static constexpr int kSumScale = 4;
  struct Best {
    Key key;
    Int16s group;
  };

  static Key without_sum(int disparity) { return WideKeys::without_sum(disparity % kGroup); }
  static Best best_of_none() { return {none(), Int16s{}}; }
  // The smaller sum wins. Of equal sums `best` wins, whose disparity is smaller.
  static Best better(const Best& best, const Best& other) {
    const Int32s even = (best.key.even & -kSumScale) > other.key.even;
    const Int32s odd = (best.key.odd & -kSumScale) > other.key.odd;
    return {{even ? other.key.even : best.key.even, odd ? other.key.odd : best.key.odd},
            join_lanes(even, odd) ? other.group : best.group};
  }
  static Best better(const Best& best, const Key& key, int group) {
    return better(best, {key, int16s(group)});
  }
  static Best load_moved(const Best* best, Int16s outside) {
    return {WideKeys::load_moved(&best->key, outside),
            load<Int16s>(reinterpret_cast<const std::int16_t*>(&best->group) - 1)};
  }
  static Int16s disparity(const Best& best) {
    return best.group + join_lanes(best.key.even & (kGroup - 1), best.key.odd & (kGroup - 1));
  }
};

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
