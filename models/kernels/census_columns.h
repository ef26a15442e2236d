#pragma once

#include <cstdint>

#include "models/kernels/column_neighbourhood.h"
#include "models/kernels/pixel_column.h"

namespace stereotlm::kernels {

// Computes the census bits (contract 7.6) of filtered columns, in the order in which they leave the filter; used
// by fpga::CensusTransform. With column u those of column u - h leave, h rows further up (h = (c - 1) / 2). The
// 2h rows above the new ones come from line memories.
class CensusColumns {
 public:
  // Throws std::invalid_argument as ColumnNeighbourhood does, or if `census_size` is outside kCensusSizeRule.
  CensusColumns(int width, int height, int rows_per_column, int rows_per_strip, int census_size);

  // Begins a frame. `first_row`: see ColumnNeighbourhood.
  void start_frame(int first_row) { pixels_.start_frame(first_row); }
  // Enters the next column. Returns output(), which is that of an earlier column until the first one leaves.
  const PixelColumn& push(const PixelColumn& column);

 private:
  int size_;
  int rows_;
  ColumnNeighbourhood<std::uint8_t> pixels_;
  PixelColumn output_;
};

}  // namespace stereotlm::kernels
