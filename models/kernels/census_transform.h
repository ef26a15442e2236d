#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/matching_cost.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Computes the census bits of whole images (contract 7.6); used by ImageMatcher.
class CensusTransform {
 public:
  // Throws std::invalid_argument if the size of the census `cost` is outside kCensusSizeRule, or if the image
  // has no pixels.
  CensusTransform(int width, int height, const MatchingCost& cost, const Simd& simd = best_simd());

  // `image` holds width * height pixels, row-major. Byte b of the pixels' census bits is plane(b) afterwards.
  void run(const std::uint8_t* image);
  const std::uint8_t* plane(int byte) const { return planes_[static_cast<std::size_t>(byte)].data(); }

 private:
  int width_;
  int height_;
  int half_;
  const FrameSimd& simd_;
  std::size_t stride_;               // of padded_
  std::vector<std::int8_t> padded_;  // the image with its edges repeated, upper bits inverted
  std::vector<std::vector<std::uint8_t>> planes_;
};

}  // namespace stereotlm::kernels
