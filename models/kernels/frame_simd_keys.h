#pragma once

#include "models/kernels/frame_simd_vectors.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {

// A key combines the window sum and the disparity of a candidate, so that the smallest key is the best match.
// NarrowKeys have 16 bits, for window sums of up to 14 bits: a key is sum * 4 + disparity % 4 - 32768. The
// first disparity of the group of 4 is kept beside the best key.
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
  static Key least(Key a, Key b) { return smaller(a, b); }
  static Key most(Key key, Int16s floor) { return larger(key, floor); }
  static Key none() { return int16s(32767); }
  static Best best_of_none() { return {none(), Int16s{}}; }
  // The smaller sum wins. Of equal sums `best` wins, whose disparity is smaller.
  static Best better(const Best& best, const Best& other) {
    const auto smaller_sum = (best.key & -kGroup) > other.key;
    return {smaller_sum ? other.key : best.key, smaller_sum ? other.group : best.group};
  }
  static Best better(const Best& best, Key key, int group) { return better(best, {key, int16s(group)}); }
  // Loads the best keys, each from the lane before. `floor`: the largest value in lanes that get none(), else
  // the smallest.
  static Best load_moved(const Best* best, Int16s floor) {
    const auto* lanes = reinterpret_cast<const std::int16_t*>(best);
    return {larger(load<Int16s>(lanes - 1), floor), load<Int16s>(lanes + kLanes - 1)};
  }
  static Int16s disparity(const Best& best) { return best.group + (best.key & (kGroup - 1)); }
};

// WideKeys have 32 bits, for any window: a key is sum * 256 + disparity. Even and odd lanes have separate
// vectors.
struct WideKeys {
  static constexpr int kGroup = 2;
  static constexpr int kScale = 1;
  struct Key {
    Int32s even;
    Int32s odd;
  };
  using Best = Key;

  static Key without_sum(int disparity) { return {int32s(disparity), int32s(disparity)}; }
  static void add(Key& key, Int16s column_sum) {
    key.even += even_lanes(column_sum) << 8;
    key.odd += odd_lanes(column_sum) << 8;
  }
  static Key least(const Key& a, const Key& b) { return {smaller(a.even, b.even), smaller(a.odd, b.odd)}; }
  static Key most(const Key& key, Int16s floor) {
    return {larger(key.even, even_lanes(floor) << 16), larger(key.odd, odd_lanes(floor) << 16)};
  }
  static Key none() { return {int32s(0x7FFF0000), int32s(0x7FFF0000)}; }
  static Best best_of_none() { return none(); }
  static Best better(const Best& best, const Best& other) { return least(best, other); }
  static Best better(const Best& best, const Key& key, int /*group*/) { return least(best, key); }
  static Best load_moved(const Best* best, Int16s floor) {
    const auto* lanes = reinterpret_cast<const std::int32_t*>(best);
    return most({load<Int32s>(lanes + kLanes / 2 - 1), best->even}, floor);
  }
  static Int16s disparity(const Best& best) { return join_lanes(best.even & 0xFF, best.odd & 0xFF); }
};

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
