#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/matching_cost.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// The number of candidates of left pixel (column, row): disparities whose windows lie wholly inside both
// images (contract 1.3). They are always 0, 1, .. without a gap.
constexpr int candidate_count(int column, int row, int width, int height, int window, int disparities) {
  const int radius = (window - 1) / 2;
  if (row < radius || row >= height - radius || column < radius || column >= width - radius) return 0;
  return column - radius + 1 < disparities ? column - radius + 1 : disparities;
}

// The array of column and window modules (paper section 3.4, figures 6 and 8); used by fpga::CostArray.
// Column module d sums the costs of the n pixel pairs of a column: the left pixels and the right pixels of d
// columns before. The cost is the absolute difference, its square, the number of census bits that differ, or
// (`zncc`) the product. Window module d adds the new column sum and subtracts that of n columns before. It
// then holds the sum of candidate d for the window that ends at this column.
class CostColumns {
 public:
  // `window` keeps kWindowRule, `disparities` kDisparitiesRule; the cost has no problems.
  CostColumns(int window, int disparities, const MatchingCost& cost = {}, const Simd& simd = best_simd())
      : simd_(simd),
        cost_(cost),
        window_(window),
        rows_(window * cost.pixel_bytes()),
        lanes_(padded_lanes(disparities)),
        right_histories_(static_cast<std::size_t>(rows_) *
                         static_cast<std::size_t>(kColumnsBetweenMoves + lanes_)),
        newest_(static_cast<std::size_t>(rows_)),
        window_sums_(disparities) {
    const auto columns = static_cast<std::size_t>(window);
    if (cost.kind == CostKind::kSad || cost.kind == CostKind::kCensus) {
      narrow_sums_.assign(columns, SimdArray<std::int16_t>(disparities));
    } else {
      wide_sums_.assign(columns, SimdArray<std::int32_t>(disparities));
    }
    start_frame();
  }

  void start_frame() {
    std::fill(right_histories_.begin(), right_histories_.end(), std::uint8_t{0});
    for (auto& sums : narrow_sums_) sums.fill(0);
    for (auto& sums : wide_sums_) sums.fill(0);
    window_sums_.fill(0);
    oldest_ = 0;
    position_ = kColumnsBetweenMoves;
  }
  // Enters the next column of each side: n pixels of pixel_bytes() each, top first.
  void push_column(const std::uint8_t* left, const std::uint8_t* right) {
    const std::ptrdiff_t stride = kColumnsBetweenMoves + lanes_;
    std::uint8_t* history = right_histories_.data();
    if (position_ == 0) {
      // A history grows downwards, newest pixel first. At the bottom, the part that is still needed moves to
      // the top.
      for (int row = 0; row < rows_; ++row, history += stride) {
        std::copy_n(history, lanes_, history + kColumnsBetweenMoves);
      }
      position_ = kColumnsBetweenMoves;
      history = right_histories_.data();
    }
    --position_;
    for (int row = 0; row < rows_; ++row, history += stride) {
      history[position_] = right[row];
      newest_[static_cast<std::size_t>(row)] = history + position_;
    }
    const auto oldest = static_cast<std::size_t>(oldest_);
    const auto step = [&](auto loop, auto& sums) {
      loop(newest_.data(), left, rows_, lanes_, sums[oldest].data(), window_sums_.data());
    };
    switch (cost_.kind) {
      case CostKind::kSad:
        step(simd_.sad_windows, narrow_sums_);
        break;
      case CostKind::kCensus:
        step(simd_.census_windows, narrow_sums_);
        break;
      case CostKind::kSsd:
        step(simd_.ssd_windows, wide_sums_);
        break;
      case CostKind::kZncc:
        step(simd_.product_windows, wide_sums_);
        break;
    }
    oldest_ = oldest_ + 1 == window_ ? 0 : oldest_ + 1;
  }
  // The sums of candidates 0..disparities-1 for the last column, padded to lanes() values.
  const std::int32_t* window_sums() const { return window_sums_.data(); }
  int lanes() const { return lanes_; }

 private:
  static constexpr int kColumnsBetweenMoves = 1024;

  const Simd& simd_;
  MatchingCost cost_;
  int window_;
  int rows_;  // bytes of a column
  int lanes_;
  int position_ = 0;                           // of the newest right pixel in each history
  int oldest_ = 0;                             // index of the column sums that leave the window next
  std::vector<std::uint8_t> right_histories_;  // per byte of a column: newest column first
  std::vector<const std::uint8_t*> newest_;    // per byte: the newest pixel in its history
  // Column sums of the last n columns. Absolute differences and census bits fit into 16 bits: at most 31 *
  // 255 and 31 * 48.
  std::vector<SimdArray<std::int16_t>> narrow_sums_;
  std::vector<SimdArray<std::int32_t>> wide_sums_;
  SimdArray<std::int32_t> window_sums_;  // at most 31 * 31 * 255 * 255
};

}  // namespace stereotlm::kernels
