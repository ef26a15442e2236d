#include "models/kernels/census.h"

#include <algorithm>
#include <array>

namespace stereotlm::kernels {

CensusColumns::CensusColumns(int width, int height, int rows_per_column, int rows_per_strip,
                             const MatchingCost& cost)
    : half_(cost.half()),
      rows_(rows_per_column),
      pixels_(width, height, rows_per_column, rows_per_strip, half_),
      output_(static_cast<std::size_t>(rows_per_column * cost.pixel_bytes())) {
  start_frame(0);
}

PixelColumn CensusColumns::push(const PixelColumn& column) {
  std::copy_n(column.values, rows_, pixels_.begin_column());
  if (!pixels_.finish_column(column.valid)) return output();
  const std::uint8_t* const columns = pixels_.columns();
  const std::ptrdiff_t half = half_;
  std::uint8_t* out = output_.data();
  for (std::ptrdiff_t k = 0; k < rows_; ++k) {
    const std::uint8_t middle = columns[half * pixels_.stride() + half + k];
    unsigned bits = 0;
    int bit = 0;
    for (std::ptrdiff_t i = 0; i <= 2 * half; ++i) {
      for (std::ptrdiff_t j = 0; j <= 2 * half; ++j) {
        if (i == half && j == half) continue;
        bits = bits << 1U | unsigned{columns[i * pixels_.stride() + k + j] < middle};
        if (++bit % 8 == 0) *out++ = static_cast<std::uint8_t>(bits);
      }
    }
  }
  output_valid_ = pixels_.valid();
  return output();
}

CensusTransform::CensusTransform(int width, int height, const MatchingCost& cost, const Simd& simd)
    : width_(width),
      height_(height),
      half_(cost.half()),
      simd_(simd),
      stride_(static_cast<std::size_t>(width + 2 * half_ + kMostFrameVectorBytes)) {
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
