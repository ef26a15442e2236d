#pragma once

#include <cstdint>
#include <vector>

#include "models/kernels/column_neighbourhood.h"
#include "models/kernels/matching_cost.h"
#include "models/kernels/pixel_column.h"

namespace stereotlm::kernels {

// Computes the census bits (contract 7.6) of filtered columns, in the order in which they leave the filter;
// used by fpga::Census. With column u those of column u - h leave, h rows further up (h = (c - 1) / 2). The
// 2h rows above the new ones come from line memories.
class CensusColumns {
 public:
  // Throws std::invalid_argument as ColumnNeighbourhood does, or if the size of the census `cost` is outside
  // kCensusSizeRule.
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

}  // namespace stereotlm::kernels
