#include "models/kernels/select_min.h"

#include <limits>

#include "models/kernels/limits.h"
#include "models/kernels/words.h"

namespace stereotlm::kernels {
namespace {

// A key holds the sum in its upper bits and the disparity in the lowest 8: the smallest key is the smallest
// sum, and among equal sums the smallest disparity. 31 * 31 * 255 needs 18 bits.
constexpr std::int32_t kNoCandidate = std::numeric_limits<std::int32_t>::max();
// Number of values before that of module 0, which reads the last of them as the value of module -1.
constexpr int kBefore = kLanePadding;

constexpr std::uint8_t disparity_of(std::int32_t key) {
  return key == kNoCandidate ? kInvalidDisparity : static_cast<std::uint8_t>(key & 0xFF);
}

}  // namespace

std::uint8_t select_min_tree(const std::int32_t* window_sums, int candidates, int lanes, const Simd& simd) {
  return disparity_of(simd.column.smallest_key(window_sums, candidates, lanes));
}

SelectMinChain::SelectMinChain(int disparities, const Simd& simd)
    : simd_(simd.column),
      disparities_(kDisparitiesRule.required("disparities", disparities)),
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

}  // namespace stereotlm::kernels
