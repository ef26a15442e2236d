#pragma once

#include <cstdint>
#include <vector>

#include "models/kernels/column_scores.h"
#include "models/kernels/simd.h"
#include "models/kernels/words.h"

namespace stereotlm::kernels {

// The select-min units compare keys: a window sum in the upper bits and a disparity in the lowest 8. The
// smallest key is the smallest sum, and among equal sums the smallest disparity. This is the largest sum that
// fits. Other scores are compared as exact fractions.
inline constexpr std::int32_t kLargestKeySum = 0x7FFFFF;

// Select-min unit B (paper section 3.3): a tree of comparators. Returns the disparity of the smallest of the
// first `candidates` window sums, and of equal sums the smaller disparity; kInvalidDisparity without
// candidates. The sums of one column belong to one left pixel: left-based matching.
std::uint8_t select_min_tree(const std::int32_t* window_sums, int candidates, int lanes,
                             const Simd& simd = best_simd());
std::uint8_t select_min_tree(const ColumnScores& scores, int candidates);

// Select-min unit A: a chain of `disparities` compare-and-shift modules. In each column, module d compares
// the sum that module d-1 held a column ago with the sum of candidate d, and keeps the smaller sum. If they
// are equal, it keeps the sum of module d-1. The minimum that leaves the chain belongs to the right pixel
// disparities-1 columns back: right-based matching.
class SelectMinChain {
 public:
  explicit SelectMinChain(int disparities, const Simd& simd = best_simd());

  void start_frame();
  // One column: the first `candidates` window sums take part. Returns the disparity for the right pixel
  // disparities-1 columns back, kInvalidDisparity if it had no candidate.
  std::uint8_t step(const std::int32_t* window_sums, int candidates);

 private:
  const Simd& simd_;
  int disparities_;
  int lanes_;
  SimdArray<std::int32_t> held_;  // [kBefore + d]: key that module d holds; before module 0, no candidate
  SimdArray<std::int32_t> next_;  // written by step(), then swapped with held_
};

// The same chain for scores. If two scores are equal, module d keeps the score of module d-1 here too.
class ScoreChain {
 public:
  explicit ScoreChain(int disparities);

  void start_frame();
  std::uint8_t step(const ColumnScores& scores, int candidates);

 private:
  struct Held {
    Correlation score;
    std::uint8_t disparity = kInvalidDisparity;
  };
  std::vector<Held> held_;  // [d]: what module d holds
};

}  // namespace stereotlm::kernels
