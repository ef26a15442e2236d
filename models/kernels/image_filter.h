#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "models/checked.h"
#include "models/kernels/filter_kernel.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Filters whole images with a kernel (contract 1.2); used by StereoPipeline.
class ImageFilter {
 public:
  // Bytes behind the last pixel that run() may write.
  static constexpr std::size_t kPadding = kMostFrameVectorBytes;

  // Throws std::invalid_argument if the kernel has problems or the image has no pixels.
  ImageFilter(int width, int height, const FilterKernel& kernel, const Simd& simd = best_simd())
      : width_(width), height_(height), half_(kernel.half()), simd_(simd) {
    if (width < 1 || height < 1) {
      throw std::invalid_argument("image = " + std::to_string(width) + " x " + std::to_string(height) +
                                  ": must have pixels");
    }
    checked(kernel);

    std::int64_t positive = 0;
    for (const int weight : kernel.weights) positive += std::max(weight, 0);
    // The weights sum to 0, so that every sum lies in -255 * positive .. 255 * positive.
    wide_ = positive * 255 > std::numeric_limits<std::int32_t>::max();

    for (int row = 0; row < kernel.size; ++row) {
      const auto first = kernel.weights.begin() + std::ptrdiff_t{row} * kernel.size;
      std::vector<int> weights(first, first + kernel.size);
      const auto same = std::find_if(equal_rows_.begin(), equal_rows_.end(),
                                     [&](const EqualRows& equal) { return equal.weights == weights; });
      if (same != equal_rows_.end()) {
        same->rows.push_back(row - half_);
      } else {
        equal_rows_.push_back({{row - half_}, std::move(weights), {}});
      }
    }
    taps_ = {static_cast<int>(equal_rows_.size()), (kernel.size + 1) / 2, kernel.shift, nullptr};
    for (EqualRows& equal : equal_rows_) {
      // Vectors read beyond the end, and the last pair reads one more column.
      equal.sums = VectorArray(static_cast<std::size_t>(width + kernel.size + 1) + kPadding);
      sums_.push_back(equal.sums.data());
      for (int column = 0; column < kernel.size; column += 2) {
        const auto at = [&](int i) {
          return i < kernel.size ? static_cast<std::uint32_t>(equal.weights[static_cast<std::size_t>(i)])
                                 : 0U;
        };
        pair_weights_.push_back(static_cast<std::int32_t>((at(column) & 0xFFFFU) | at(column + 1) << 16U));
      }
    }
    taps_.weights = pair_weights_.data();
  }
  ImageFilter(const ImageFilter&) = delete;
  ImageFilter& operator=(const ImageFilter&) = delete;

  // `image` holds width * height pixels, row-major; `filtered` has room for kPadding more.
  void run(const std::uint8_t* image, std::uint8_t* filtered) {
    for (int row = 0; row < height_; ++row, filtered += width_) {
      for (EqualRows& equal : equal_rows_) add_rows(equal, image, row);
      if (wide_) {
        filter_row_wide(filtered);
      } else {
        simd_.filter_row(sums_.data(), taps_, width_, filtered);
      }
    }
  }

 private:
  // Kernel rows with the same weights: their pixels are added up before they are weighted.
  struct EqualRows {
    std::vector<int> rows;  // offsets of these kernel rows from the centre
    std::vector<int> weights;
    VectorArray sums;  // sums of the image rows at these offsets, with half_ more columns on each side
  };

  void add_rows(EqualRows& equal, const std::uint8_t* image, int row) {
    std::array<const std::uint8_t*, static_cast<std::size_t>(kKernelSizeRule.max)> rows{};
    std::size_t count = 0;
    for (const int offset : equal.rows)
      rows[count++] = image + std::ptrdiff_t{std::clamp(row + offset, 0, height_ - 1)} * width_;
    std::int16_t* sums = equal.sums.data();
    simd_.add_rows(rows.data(), static_cast<int>(count), width_, sums + half_);
    std::fill_n(sums, half_, sums[half_]);
    std::fill_n(sums + half_ + width_, half_, sums[half_ + width_ - 1]);
  }
  void filter_row_wide(std::uint8_t* out) const {
    for (int u = 0; u < width_; ++u) {
      std::int64_t sum = 0;
      for (const EqualRows& equal : equal_rows_) {
        const std::int16_t* pixels = equal.sums.data() + u;
        for (const int weight : equal.weights) sum += std::int64_t{weight} * *pixels++;
      }
      out[u] = static_cast<std::uint8_t>(std::clamp<std::int64_t>(128 + (sum >> taps_.shift), 0, 255));
    }
  }

  int width_;
  int height_;
  int half_;
  const Simd& simd_;
  std::vector<EqualRows> equal_rows_;
  std::vector<const std::int16_t*> sums_;  // EqualRows::sums of all equal_rows_
  std::vector<std::int32_t> pair_weights_;
  FilterTaps taps_;
  bool wide_ = false;  // a sum may exceed 32 bits
};

}  // namespace stereotlm::kernels
