#pragma once

#include <cstdint>

namespace stereotlm::kernels {

// The candidates of a window: windows of the other side, for the disparities 0..count-1. The arrays may
// be read up to the next multiple of kLanePadding.
struct Candidates {
  int count;
  const double* sums;  // of the pixels of each candidate
  const std::int64_t* variances;
  const double* inverses;  // 1 / variance
};

// The loops of CorrelationSearch, for one instruction set.
struct CorrelationSimd {
  // Adds the sum over the 2 * `pairs` rows of own[row] * rows[row][d] to column[d], then column[d] -
  // leaving[d] to window[d], for `lanes` disparities d, a multiple of kLanePadding.
  void (*add_products)(const std::uint8_t* const* rows, const std::int16_t* own, int pairs, int lanes,
                       std::int32_t* column, const std::int32_t* leaving, std::int32_t* window);

  // Returns the first candidate with the greatest score, for a window of `pixels` pixels with the sum
  // `own_sum`. products[d]: the sum of its pixels times those of candidate d. Arrays are padded like those of
  // the candidates; `quotients` is memory for the work.
  int (*best_candidate)(const Candidates& candidates, const std::int32_t* products, double pixels,
                        double own_sum, double* quotients);
};

}  // namespace stereotlm::kernels
