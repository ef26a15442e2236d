#pragma once

#include "models/kernels/frame_simd_vectors.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {

// Keys of 16 bits, for window sums of up to 14 bits: the sum above the last two bits of the disparity,
// counted from the smallest 16-bit value. The first disparity of a group of 4 is kept beside the best key.
struct NarrowKeys {
  static constexpr int kGroup = 4;
  static constexpr int kScale = 4;
  using Key = Halves;
  struct Best {
    Halves key;
    Halves group;
  };

  static Key without_sum(int disparity) { return halves(-32768 + disparity % kGroup); }
  static void add(Key& key, Halves column_sum) { key += column_sum; }
  static Key least(Key a, Key b) { return smaller(a, b); }
  static Key most(Key key, Halves floor) { return larger(key, floor); }
  static Key none() { return halves(32767); }
  static Best best_of_none() { return {none(), Halves{}}; }
  // The smaller sum wins. Of equal sums `best` wins, whose disparity is smaller.
  static Best better(const Best& best, const Best& other) {
    const auto smaller_sum = (best.key & -kGroup) > other.key;
    return {smaller_sum ? other.key : best.key, smaller_sum ? other.group : best.group};
  }
  static Best better(const Best& best, Key key, int group) { return better(best, {key, halves(group)}); }
  // Moves the best of each lane to the next lane.
  static Best load_moved(const Best* best, Halves floor) {
    const auto* lanes = reinterpret_cast<const std::int16_t*>(best);
    return {larger(load<Halves>(lanes - 1), floor), load<Halves>(lanes + kLanes - 1)};
  }
  static Halves disparity(const Best& best) { return best.group + (best.key & (kGroup - 1)); }
};

// Keys of 32 bits: any sum above the whole disparity.
struct WideKeys {
  static constexpr int kGroup = 2;
  static constexpr int kScale = 1;
  struct Key {
    Words even;
    Words odd;
  };
  using Best = Key;

  static Key without_sum(int disparity) { return {words(disparity), words(disparity)}; }
  static void add(Key& key, Halves column_sum) {
    key.even += even_lanes(column_sum) << 8;
    key.odd += odd_lanes(column_sum) << 8;
  }
  static Key least(const Key& a, const Key& b) { return {smaller(a.even, b.even), smaller(a.odd, b.odd)}; }
  static Key most(const Key& key, Halves floor) {
    return {larger(key.even, even_lanes(floor) << 16), larger(key.odd, odd_lanes(floor) << 16)};
  }
  static Key none() { return {words(0x7FFF0000), words(0x7FFF0000)}; }
  static Best best_of_none() { return none(); }
  static Best better(const Best& best, const Best& other) { return least(best, other); }
  static Best better(const Best& best, const Key& key, int /*group*/) { return least(best, key); }
  static Best load_moved(const Best* best, Halves floor) {
    const auto* lanes = reinterpret_cast<const std::int32_t*>(best);
    return most({load<Words>(lanes + kLanes / 2 - 1), best->even}, floor);
  }
  static Halves disparity(const Best& best) { return join_lanes(best.even & 0xFF, best.odd & 0xFF); }
};

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
