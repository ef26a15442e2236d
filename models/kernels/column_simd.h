#pragma once

#include <cstddef>
#include <cstdint>

namespace stereotlm::kernels {

// Arrays with one value per disparity are padded to a multiple of this many values. ColumnSimd reads and
// writes the padding.
inline constexpr int kLanePadding = 16;
// Alignment of these arrays, and length of the longest vector that ColumnSimd uses, in bytes.
inline constexpr int kLaneAlignment = 32;

// ColumnSimd::filter_column works on blocks of this many rows.
inline constexpr int kFilterBlock = 8;
constexpr int padded_rows(int rows) { return (rows + kFilterBlock - 1) / kFilterBlock * kFilterBlock; }

// The loops over one column of the matcher, for one instruction set. Arrays over the disparities d hold
// `lanes` values, a multiple of kLanePadding; arrays with values of more than 8 bits must be LaneArrays.
struct ColumnSimd {
  // Steps all column and window modules by one column. For each d: adds the sum over the `rows` of
  // |histories[row][d] - left[row]| to windows[d], subtracts leaving[d], and stores the sum in leaving[d].
  void (*sad_windows)(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                      std::int16_t* leaving, std::int32_t* windows);
  // The same with the number of bits in which histories[row][d] and left[row] differ.
  void (*census_windows)(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                         std::int16_t* leaving, std::int32_t* windows);
  // The same with the square of the difference, and with the product.
  void (*ssd_windows)(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                      std::int32_t* leaving, std::int32_t* windows);
  void (*product_windows)(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                          std::int32_t* leaving, std::int32_t* windows);

  // Steps select-min unit A by one column: next[d] = min(held[d - 1], key(d)), where key(d) = sums[d] * 256 +
  // d for d < candidates, else INT32_MAX. Reads held[-1]; writes `next` from 0 on.
  void (*step_chain)(const std::int32_t* sums, int candidates, int lanes, const std::int32_t* held,
                     std::int32_t* next);

  // Select-min unit B: returns the smallest key(d).
  std::int32_t (*smallest_key)(const std::int32_t* sums, int candidates, int lanes);

  // Filters `rows` pixels of one column with a size x size kernel (size odd): out[k] = clamp(128 + floor(S /
  // 2^shift), 0, 255), where S = sum over i, j of weights[i * size + j] * (value k + j of column i), and
  // column i starts at columns + i * stride. Exact while no partial sum leaves -2^24..2^24. Reads columns up
  // to padded_rows(rows) + size - 1, and writes `out` up to padded_rows(rows).
  void (*filter_column)(const float* columns, std::ptrdiff_t stride, const float* weights, int size, int rows,
                        int shift, std::uint8_t* out);
};

}  // namespace stereotlm::kernels
