#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "models/kernels/column_scores.h"
#include "models/kernels/simd.h"
#include "models/kernels/words.h"

namespace stereotlm::kernels {

inline constexpr std::int32_t kNoCandidate = std::numeric_limits<std::int32_t>::max();  // a key
constexpr std::uint8_t disparity_of(std::int32_t key) {  // kInvalidDisparity for kNoCandidate
  return key == kNoCandidate ? kInvalidDisparity : static_cast<std::uint8_t>(key & 0xFF);
}

// Select-min unit B (paper section 3.3): a tree of comparators. Returns the disparity of the smallest of the
// first `candidates` window sums, and of equal sums the smaller disparity; kInvalidDisparity without
// candidates. The sums of one column belong to one left pixel: left-based matching.
inline std::uint8_t select_min_tree(const std::int32_t* window_sums, int candidates, int lanes,
                                    const Simd& simd = best_simd()) {
  return disparity_of(simd.smallest_key(window_sums, candidates, lanes));
}
// The same for scores, of which the greatest wins.
inline std::uint8_t select_min_tree(const ColumnScores& scores, int candidates) {
  if (candidates == 0) return kInvalidDisparity;
  int best = 0;
  for (int d = 1; d < candidates; ++d) {
    if (is_greater(scores.of_left_pixel(d), scores.of_left_pixel(best))) best = d;
  }
  return static_cast<std::uint8_t>(best);
}

// Select-min unit A: a chain of `disparities` compare-and-shift modules. In each column, module d compares
// the sum that module d-1 held a column ago with the sum of candidate d, and keeps the smaller sum. If they
// are equal, it keeps the sum of module d-1. The minimum that leaves the chain belongs to the right pixel
// disparities-1 columns back: right-based matching.
class SelectMinChain {
 public:
  // `disparities`: D.
  explicit SelectMinChain(int disparities, const Simd& simd = best_simd())
      : simd_(simd),
        disparities_(disparities),
        lanes_(padded_lanes(disparities)),
        held_(kBefore + disparities),
        next_(kBefore + disparities) {
    start_frame();
  }

  void start_frame() {  // to be called before the first column of a frame
    held_.fill(kNoCandidate);
    next_.fill(kNoCandidate);
  }
  // One column: the first `candidates` window sums take part. Returns the disparity for the right pixel
  // disparities-1 columns back, kInvalidDisparity if it had no candidate.
  std::uint8_t step(const std::int32_t* window_sums, int candidates) {
    simd_.step_chain(window_sums, candidates, lanes_, held_.data() + kBefore, next_.data() + kBefore);
    held_.swap(next_);
    return disparity_of(held_.data()[kBefore + disparities_ - 1]);
  }

 private:
  // Number of values before the value of module 0. Module 0 reads the last of them as the value of module -1.
  static constexpr int kBefore = kLanePadding;

  const Simd& simd_;
  int disparities_;
  int lanes_;
  SimdArray<std::int32_t> held_;  // [kBefore + d]: key that module d holds; before module 0, no candidate
  SimdArray<std::int32_t> next_;  // written by step(), then swapped with held_
};

// The same chain for scores. If two scores are equal, module d keeps the score of module d-1 here too.
class ScoreChain {
 public:
  explicit ScoreChain(int disparities) : held_(static_cast<std::size_t>(disparities)) {}  // `disparities`: D

  void start_frame() { std::fill(held_.begin(), held_.end(), Held{}); }  // before the first column of a frame
  std::uint8_t step(const ColumnScores& scores, int candidates) {        // as SelectMinChain::step()
    for (std::size_t d = held_.size(); d-- > 0;) {
      const Held before = d > 0 ? held_[d - 1] : Held{};
      held_[d] = before;
      if (static_cast<int>(d) >= candidates) continue;
      const Correlation score = scores.of_right_pixel(static_cast<int>(d));
      if (before.disparity == kInvalidDisparity || is_greater(score, before.score))
        held_[d] = {score, static_cast<std::uint8_t>(d)};
    }
    return held_.back().disparity;
  }

 private:
  struct Held {
    Correlation score;
    std::uint8_t disparity = kInvalidDisparity;
  };
  std::vector<Held> held_;  // [d]: what module d holds
};

}  // namespace stereotlm::kernels
