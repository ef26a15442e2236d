#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "models/kernels/column_simd.h"

namespace stereotlm::kernels {

// Lanes here are those of vector instructions, one for each disparity.
constexpr int padded_lanes(int disparities) {
  return (disparities + kLanePadding - 1) / kLanePadding * kLanePadding;
}

// An array for ColumnSimd with at least `lanes` values, aligned and padded, at first zeros.
template <class Value>
class LaneArray {
 public:
  explicit LaneArray(int lanes) : blocks_(static_cast<std::size_t>(padded_lanes(lanes) / kLanePadding)) {}
  Value* data() { return blocks_.data()->data(); }
  const Value* data() const { return blocks_.data()->data(); }
  void fill(Value value) {
    for (Block& block : blocks_) std::fill(block.begin(), block.end(), value);
  }
  void swap(LaneArray& other) { blocks_.swap(other.blocks_); }

 private:
  struct alignas(kLaneAlignment) Block : std::array<Value, kLanePadding> {};
  std::vector<Block> blocks_;
};

}  // namespace stereotlm::kernels
