#include "models/kernels/census_transform.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace stereotlm::kernels {

CensusTransform::CensusTransform(int width, int height, const MatchingCost& cost, const Simd& simd)
    : width_(width),
      height_(height),
      half_(cost.half()),
      simd_(simd.frame),
      stride_(static_cast<std::size_t>(width + 2 * half_ + kMostFrameVectorBytes)) {
  kCensusSizeRule.required("census_size", cost.census_size);
  if (width < 1 || height < 1) {
    throw std::invalid_argument("image = " + std::to_string(width) + " x " + std::to_string(height) +
                                ": must have pixels");
  }
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  padded_.resize(static_cast<std::size_t>(height) * stride_);
  planes_.resize(static_cast<std::size_t>(cost.pixel_bytes()));
  for (auto& plane : planes_) plane.resize(pixels + kMostFrameVectorBytes);
}

void CensusTransform::run(const std::uint8_t* image) {
  for (int row = 0; row < height_; ++row) {
    const std::uint8_t* const from = image + std::ptrdiff_t{row} * width_;
    std::int8_t* const to = padded_.data() + static_cast<std::size_t>(row) * stride_;
    for (int u = 0; u < width_; ++u) to[half_ + u] = static_cast<std::int8_t>(from[u] ^ 0x80U);
    std::fill_n(to, half_, to[half_]);
    std::fill_n(to + half_ + width_, half_, to[half_ + width_ - 1]);
  }
  std::array<const std::int8_t*, static_cast<std::size_t>(kCensusSizeRule.max)> rows{};
  std::array<std::uint8_t*, kMostPixelBytes> out{};
  for (int row = 0; row < height_; ++row) {
    for (int j = 0; j <= 2 * half_; ++j) {
      rows[static_cast<std::size_t>(j)] =
          padded_.data() + static_cast<std::size_t>(std::clamp(row + j - half_, 0, height_ - 1)) * stride_;
    }
    for (std::size_t byte = 0; byte < planes_.size(); ++byte)
      out[byte] = planes_[byte].data() + std::ptrdiff_t{row} * width_;
    simd_.census_row(rows.data(), half_, width_, out.data());
  }
}

}  // namespace stereotlm::kernels
