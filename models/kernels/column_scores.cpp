#include "models/kernels/column_scores.h"

#include <algorithm>
#include <cstddef>

#include "models/kernels/select_min.h"

namespace stereotlm::kernels {

bool ColumnScorer::is_needed(int window, const MatchingCost& cost) {
  const std::int64_t largest_sum = std::int64_t{window} * window * 255 * 255;
  return cost.kind == CostKind::kZncc || (cost.kind == CostKind::kSsd && largest_sum > kLargestKeySum);
}

ColumnScorer::ColumnScorer(int window, int disparities, const MatchingCost& cost)
    : window_(window), pixels_(std::int64_t{window} * window), are_products_(cost.kind == CostKind::kZncc) {
  const auto candidates = static_cast<std::size_t>(disparities);
  right_history_.resize(candidates);
  covariances_.resize(candidates);
  right_variances_.assign(candidates, 1);
  start_frame();
}

void ColumnScorer::start_frame() {
  for (Side* side : {&left_, &right_}) {
    side->window = {};
    side->columns.assign(static_cast<std::size_t>(window_), {});
  }
  std::fill(right_history_.begin(), right_history_.end(), PixelSums{});
  oldest_ = 0;
}

void ColumnScorer::push(Side& side, const std::uint8_t* pixels) const {
  PixelSums column;
  for (int row = 0; row < window_; ++row) {
    column.pixels += pixels[row];
    column.squares += pixels[row] * pixels[row];
  }
  PixelSums& leaving = side.columns[oldest_];
  side.window.pixels += column.pixels - leaving.pixels;
  side.window.squares += column.squares - leaving.squares;
  leaving = column;
}

void ColumnScorer::push_column(const std::uint8_t* left, const std::uint8_t* right,
                               const std::int32_t* window_sums) {
  scores_.covariances = covariances_.data();
  scores_.right_variances = right_variances_.data();
  const std::size_t candidates = covariances_.size();
  if (!are_products_) {
    for (std::size_t d = 0; d < candidates; ++d) covariances_[d] = -std::int64_t{window_sums[d]};
    return;
  }
  push(left_, left);
  push(right_, right);
  oldest_ = oldest_ + 1 == left_.columns.size() ? 0 : oldest_ + 1;
  std::copy_backward(right_history_.begin(), right_history_.end() - 1, right_history_.end());
  std::copy_backward(right_variances_.begin(), right_variances_.end() - 1, right_variances_.end());
  right_history_.front() = right_.window;
  right_variances_.front() = right_.window.variance(pixels_);
  scores_.left_variance = left_.window.variance(pixels_);
  for (std::size_t d = 0; d < candidates; ++d)
    covariances_[d] = covariance(pixels_, window_sums[d], left_.window, right_history_[d]);
}

}  // namespace stereotlm::kernels
