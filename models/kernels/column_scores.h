#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/kernels/correlation.h"
#include "models/kernels/matching_cost.h"

namespace stereotlm::kernels {

// The select-min units compare keys: a window sum in the upper bits and a disparity in the lowest 8. The
// smallest key is the smallest sum, and among equal sums the smallest disparity. kLargestKeySum is the
// largest sum that fits. Scores that do not fit are compared as exact fractions.
inline constexpr std::int32_t kLargestKeySum = 0x7FFFFF;

// The scores of the candidates of one column, as exact fractions; the greatest wins. The variance that all
// candidates of a pixel share is left out: the score is cov * |cov| / var_r for a left pixel, and
// cov * |cov| / var_l for a right pixel.
struct ColumnScores {
  const std::int64_t* covariances = nullptr;      // [d]
  const std::int64_t* right_variances = nullptr;  // [d]: of the right window d columns ago
  std::int64_t left_variance = 1;

  Correlation of_left_pixel(int d) const { return {covariances[d], right_variances[d]}; }
  Correlation of_right_pixel(int d) const { return {covariances[d], left_variance}; }
};

// Makes the scores of costs whose window sums cannot be compared as keys (select_min.h); used by
// fpga::CostArray.
class ColumnScorer {
 public:
  // Whether the window sums of a cost cannot be compared as keys.
  static bool is_needed(int window, const MatchingCost& cost) {
    const std::int64_t largest_sum = std::int64_t{window} * window * 255 * 255;
    return cost.kind == CostKind::kZncc || (cost.kind == CostKind::kSsd && largest_sum > kLargestKeySum);
  }

  ColumnScorer(int window, int disparities, const MatchingCost& cost)
      : window_(window), pixels_(std::int64_t{window} * window), are_products_(cost.kind == CostKind::kZncc) {
    const auto candidates = static_cast<std::size_t>(disparities);
    right_history_.resize(candidates);
    covariances_.resize(candidates);
    right_variances_.assign(candidates, 1);
    start_frame();
  }

  void start_frame() {
    for (ImageColumns* side : {&left_, &right_}) {
      side->window = {};
      side->columns.assign(static_cast<std::size_t>(window_), {});
    }
    std::fill(right_history_.begin(), right_history_.end(), PixelSums{});
    oldest_ = 0;
  }
  // Enters the next column of each side: n pixels, top first. `window_sums`: the sums of CostColumns after
  // the same columns. Sums of ssd become negative covariances with a variance of 1, so that the smallest sum
  // wins.
  void push_column(const std::uint8_t* left, const std::uint8_t* right, const std::int32_t* window_sums) {
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
  // Valid until the next push_column().
  const ColumnScores& scores() const { return scores_; }

 private:
  struct ImageColumns {
    PixelSums window;
    std::vector<PixelSums> columns;  // the last n
  };

  void push(ImageColumns& side, const std::uint8_t* pixels) const {
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

  int window_;
  std::int64_t pixels_;  // N
  bool are_products_;
  ImageColumns left_;
  ImageColumns right_;
  std::size_t oldest_ = 0;                // index of the columns that leave the windows next
  std::vector<PixelSums> right_history_;  // [d]: the right window d columns ago
  std::vector<std::int64_t> covariances_;
  std::vector<std::int64_t> right_variances_;
  ColumnScores scores_;
};

}  // namespace stereotlm::kernels
