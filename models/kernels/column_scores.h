#pragma once

#include <cstdint>
#include <vector>

#include "models/kernels/correlation.h"
#include "models/kernels/matching_cost.h"

namespace stereotlm::kernels {

// The scores of the candidates of one column, as exact fractions; the greatest wins. All candidates of a left
// pixel share the variance of its window, so only the variances of the right windows enter the scores. For a
// right pixel, only the variance of the left window does.
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
  static bool is_needed(int window, const MatchingCost& cost);

  ColumnScorer(int window, int disparities, const MatchingCost& cost);

  void start_frame();
  // Enters the next column of each side: n pixels, top first. `window_sums`: the sums of CostColumns after
  // the same columns. Sums that are not sums of products become negative covariances with variances of 1, so
  // that the smallest sum wins.
  void push_column(const std::uint8_t* left, const std::uint8_t* right, const std::int32_t* window_sums);
  // Valid until the next push_column().
  const ColumnScores& scores() const { return scores_; }

 private:
  struct Side {
    PixelSums window;
    std::vector<PixelSums> columns;  // the last n
  };

  void push(Side& side, const std::uint8_t* pixels) const;

  int window_;
  std::int64_t pixels_;  // N
  bool are_products_;
  Side left_;
  Side right_;
  std::size_t oldest_ = 0;                // index of the columns that leave the windows next
  std::vector<PixelSums> right_history_;  // [d]: the right window d columns ago
  std::vector<std::int64_t> covariances_;
  std::vector<std::int64_t> right_variances_;
  ColumnScores scores_;
};

}  // namespace stereotlm::kernels
