#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/filter_kernel.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Filters whole images with a kernel (contract 1.2); used by filter_image() and StereoPipeline.
class ImageFilter {
 public:
  // Bytes behind the last pixel that run() may write.
  static constexpr std::size_t kPadding = kMostFrameVectorBytes;

  // Throws std::invalid_argument if the kernel has problems or the image has no pixels.
  ImageFilter(int width, int height, const FilterKernel& kernel, const Simd& simd = best_simd());
  ImageFilter(const ImageFilter&) = delete;
  ImageFilter& operator=(const ImageFilter&) = delete;

  // `image` holds width * height pixels, row-major; `filtered` has room for kPadding more.
  void run(const std::uint8_t* image, std::uint8_t* filtered);

 private:
  // Kernel rows with the same weights: their pixels are added up before they are weighted.
  struct EqualRows {
    std::vector<int> rows;  // offsets of these kernel rows from the centre
    std::vector<int> weights;
    VectorArray sums;  // sums of the image rows at these offsets, with half_ more columns on each side
  };

  void add_rows(EqualRows& equal, const std::uint8_t* image, int row);
  void filter_row_wide(std::uint8_t* out) const;

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
