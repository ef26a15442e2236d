#include "models/kernels/census_columns.h"

#include <algorithm>
#include <cstddef>

namespace stereotlm::kernels {

CensusColumns::CensusColumns(int width, int height, int rows_per_column, int rows_per_strip,
                             const MatchingCost& cost)
    : half_(cost.half()),
      rows_(rows_per_column),
      pixels_(width, height, rows_per_column, rows_per_strip, half_),
      output_(static_cast<std::size_t>(rows_per_column * cost.pixel_bytes())) {
  kCensusSizeRule.required("census_size", cost.census_size);
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

}  // namespace stereotlm::kernels
