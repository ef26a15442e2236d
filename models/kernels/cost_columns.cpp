#include "models/kernels/cost_columns.h"

#include <algorithm>
#include <cstddef>

namespace stereotlm::kernels {
namespace {

constexpr int kColumnsBetweenMoves = 1024;

}  // namespace

CostColumns::CostColumns(int window, int disparities, const MatchingCost& cost, const Simd& simd)
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

void CostColumns::start_frame() {
  std::fill(right_histories_.begin(), right_histories_.end(), std::uint8_t{0});
  for (auto& sums : narrow_sums_) sums.fill(0);
  for (auto& sums : wide_sums_) sums.fill(0);
  window_sums_.fill(0);
  oldest_ = 0;
  position_ = kColumnsBetweenMoves;
}

void CostColumns::push_column(const std::uint8_t* left, const std::uint8_t* right) {
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

}  // namespace stereotlm::kernels
