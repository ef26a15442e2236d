#include "models/kernels/select_min.h"

#include <algorithm>
#include <limits>

#include "models/kernels/words.h"

namespace stereotlm::kernels {
namespace {

constexpr std::int32_t kNoCandidate = std::numeric_limits<std::int32_t>::max();
// Number of values before the value of module 0. Module 0 reads the last of them as the value of module -1.
constexpr int kBefore = kLanePadding;

constexpr std::uint8_t disparity_of(std::int32_t key) {
  return key == kNoCandidate ? kInvalidDisparity : static_cast<std::uint8_t>(key & 0xFF);
}

}  // namespace

std::uint8_t select_min_tree(const std::int32_t* window_sums, int candidates, int lanes, const Simd& simd) {
  return disparity_of(simd.smallest_key(window_sums, candidates, lanes));
}

std::uint8_t select_min_tree(const ColumnScores& scores, int candidates) {
  if (candidates == 0) return kInvalidDisparity;
  int best = 0;
  for (int d = 1; d < candidates; ++d) {
    if (is_greater(scores.of_left_pixel(d), scores.of_left_pixel(best))) best = d;
  }
  return static_cast<std::uint8_t>(best);
}

SelectMinChain::SelectMinChain(int disparities, const Simd& simd)
    : simd_(simd),
      disparities_(disparities),
      lanes_(padded_lanes(disparities)),
      held_(kBefore + disparities),
      next_(kBefore + disparities) {
  start_frame();
}

void SelectMinChain::start_frame() {
  held_.fill(kNoCandidate);
  next_.fill(kNoCandidate);
}

std::uint8_t SelectMinChain::step(const std::int32_t* window_sums, int candidates) {
  simd_.step_chain(window_sums, candidates, lanes_, held_.data() + kBefore, next_.data() + kBefore);
  held_.swap(next_);
  return disparity_of(held_.data()[kBefore + disparities_ - 1]);
}

ScoreChain::ScoreChain(int disparities) : held_(static_cast<std::size_t>(disparities)) {}

void ScoreChain::start_frame() { std::fill(held_.begin(), held_.end(), Held{}); }

std::uint8_t ScoreChain::step(const ColumnScores& scores, int candidates) {
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

}  // namespace stereotlm::kernels
