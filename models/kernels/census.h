#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/column_neighbourhood.h"
#include "models/kernels/matching_cost.h"
#include "models/kernels/pixel_column.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Computes the census bits (contract 7.6) of filtered columns, in the order in which they leave the filter;
// used by fpga::Census. The neighbourhood has 2h + 1 rows and columns. When column u enters, the bits of
// column u - h leave, h rows further up. The 2h rows above the new ones come from line memories.
class CensusColumns {
 public:
  // `cost` is kCensus. `rows_per_column`: pixels of a column. `rows_per_strip`: R of contract 7.2.
  CensusColumns(int width, int height, int rows_per_column, int rows_per_strip, const MatchingCost& cost)
      : half_(cost.half()),
        rows_(rows_per_column),
        pixels_(width, height, rows_per_column, rows_per_strip, half_),
        output_(static_cast<std::size_t>(rows_per_column * cost.pixel_bytes())) {
    start_frame(0);
  }

  // Begins a frame. `first_row`: see ColumnNeighbourhood.
  void start_frame(int first_row) { pixels_.start_frame(first_row); }
  // Enters the next column. Returns the column that leaves; without meaning until the first one leaves.
  PixelColumn push(const PixelColumn& column) {
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
  // The last column that has left.
  PixelColumn output() const { return {output_.data(), output_valid_}; }

 private:
  int half_;
  int rows_;
  ColumnNeighbourhood<std::uint8_t> pixels_;
  std::vector<std::uint8_t> output_;
  std::uint64_t output_valid_ = 0;
};

// Computes the census bits of whole images (contract 7.6); used by ImageMatcher.
class CensusTransform {
 public:
  // `cost` is kCensus. Images have width x height pixels.
  CensusTransform(int width, int height, const MatchingCost& cost, const Simd& simd = best_simd())
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

  // `image` holds width * height pixels, row-major. Byte b of the pixels' census bits is plane(b) afterwards.
  void run(const std::uint8_t* image) {
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
  // Width * height bytes, row-major.
  const std::uint8_t* plane(int byte) const { return planes_[static_cast<std::size_t>(byte)].data(); }

 private:
  int width_;
  int height_;
  int half_;
  const Simd& simd_;
  std::size_t stride_;               // of padded_
  std::vector<std::int8_t> padded_;  // the image with its edges repeated, upper bits inverted
  std::vector<std::vector<std::uint8_t>> planes_;
};

}  // namespace stereotlm::kernels
