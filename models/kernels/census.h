#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/column_neighbourhood.h"
#include "models/kernels/matching_cost.h"
#include "models/kernels/pixel_column.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Computes the census bits (contract 7.6) of filtered columns, in the order in which they leave the filter;
// used by fpga::Census. When column u enters, the bits of column u - h leave, h rows further up, where
// h = (c - 1) / 2. The 2h rows above the new ones come from line memories.
class CensusColumns {
 public:
  CensusColumns(int width, int height, int rows_per_column, int rows_per_strip, const MatchingCost& cost);

  // Begins a frame. `first_row`: see ColumnNeighbourhood.
  void start_frame(int first_row) { pixels_.start_frame(first_row); }
  // Enters the next column. Returns the column that leaves, or any one until the first leaves.
  PixelColumn push(const PixelColumn& column);
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
  CensusTransform(int width, int height, const MatchingCost& cost, const Simd& simd = best_simd());

  // `image` holds width * height pixels, row-major. Byte b of the pixels' census bits is plane(b) afterwards.
  void run(const std::uint8_t* image);
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
