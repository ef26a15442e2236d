#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/frame_simd.h"

namespace stereotlm::kernels {

// An array of 16-bit numbers for FrameSimd, at first zeros, aligned to the longest vector.
class VectorArray {
 public:
  VectorArray() = default;
  explicit VectorArray(std::size_t size) : blocks_((size + kMostFrameLanes - 1) / kMostFrameLanes) {}
  // Null if the array is empty.
  std::int16_t* data() { return blocks_.empty() ? nullptr : blocks_.data()->data(); }
  const std::int16_t* data() const { return blocks_.empty() ? nullptr : blocks_.data()->data(); }
  void clear() {
    for (Block& block : blocks_) block = {};
  }

 private:
  struct alignas(kMostFrameVectorBytes) Block : std::array<std::int16_t, kMostFrameLanes> {};
  std::vector<Block> blocks_;
};

}  // namespace stereotlm::kernels
