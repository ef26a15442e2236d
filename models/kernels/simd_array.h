#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/column_simd.h"
#include "models/kernels/frame_simd.h"

namespace stereotlm::kernels {

// Lanes here are those of vector instructions, one for each disparity.
constexpr int padded_lanes(int disparities) {
  return (disparities + kLanePadding - 1) / kLanePadding * kLanePadding;
}

// An array of at least `size` values, at first zeros, in whole blocks that are aligned for vectors.
template <class Value, std::size_t kBlock, std::size_t kAlignment>
class SimdArray {
 public:
  SimdArray() = default;
  template <class Size>
  explicit SimdArray(Size size) : blocks_((static_cast<std::size_t>(size) + kBlock - 1) / kBlock) {}
  // Null if the array is empty.
  Value* data() { return blocks_.empty() ? nullptr : blocks_.data()->data(); }
  const Value* data() const { return blocks_.empty() ? nullptr : blocks_.data()->data(); }
  void fill(Value value) {
    for (Block& block : blocks_) std::fill(block.begin(), block.end(), value);
  }
  void swap(SimdArray& other) { blocks_.swap(other.blocks_); }

 private:
  struct alignas(kAlignment) Block : std::array<Value, kBlock> {};
  std::vector<Block> blocks_;
};

// For ColumnSimd.
template <class Value>
using LaneArray = SimdArray<Value, kLanePadding, kLaneAlignment>;
// 16-bit numbers for FrameSimd.
using VectorArray = SimdArray<std::int16_t, kMostFrameLanes, kMostFrameVectorBytes>;

}  // namespace stereotlm::kernels
