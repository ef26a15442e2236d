#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/filter_kernel.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Filters whole images with a kernel (contract 1.2); used by StereoPipeline.
class ImageFilter {
 public:
  // Bytes behind the last pixel that run() may write.
  static constexpr std::size_t kPadding = kFilterPadding;

  // Throws std::invalid_argument if the kernel has problems or the image has no pixels.
  ImageFilter(int width, int height, const FilterKernel& kernel, const Simd& simd = best_simd());
  ImageFilter(const ImageFilter&) = delete;
  ImageFilter& operator=(const ImageFilter&) = delete;

  // `image` holds width * height pixels, row-major; `filtered` has room for kPadding more.
  void run(const std::uint8_t* image, std::uint8_t* filtered);

 private:
  // Kernel rows with the same weights: their pixels are added up first.
  struct EqualRows {
    std::vector<int> rows;  // offsets of these kernel rows from the centre
    VectorArray sums;
    const std::int16_t* pixels;  // the sums, or if there is one row, the row
  };
  // A pixel of the sum of equal rows.
  struct Tap {
    std::size_t equal_rows;
    int column;
  };

  void add_taps(int weight, const std::vector<Tap>& taps);
  void begin_group(std::uint32_t weight);
  std::int16_t* row_at(int row);
  void enter(const std::uint8_t* pixels, std::int16_t* row) const;
  void add_rows(EqualRows& equal, int row);
  void filter_row_wide(std::uint8_t* out) const;

  int width_;
  int height_;
  int half_;
  int shift_;
  const Simd& simd_;
  // The last kernel.size rows of the image, with half_ more columns on each side.
  std::vector<VectorArray> rows_;
  std::vector<EqualRows> equal_rows_;
  std::vector<WeightPair> pairs_;
  std::vector<Tap> taps_;                    // in the order of FilterTaps::pixels
  std::vector<const std::int16_t*> pixels_;  // of the row that is filtered
  bool has_second_ = true;                   // the last pair is complete
  bool wide_ = false;                        // a sum may exceed 32 bits
};

}  // namespace stereotlm::kernels
