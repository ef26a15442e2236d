#pragma once

#include "calib/rectification.h"
#include "calib/rig_fit.h"

namespace stereotlm::calib {

// The corners of a pair in its rectified pictures.
GridPair rectified(const Rig& rig, const Rectification& rectification, const GridPair& pair);

struct RowError {
  double mean_px = 0;  // of the absolute values
  double max_px = 0;
  std::size_t corners = 0;
};

// Collects the distances between the rows of the same corner in the two pictures.
class RowErrors {
 public:
  void add(const Eigen::Vector2d& left, const Eigen::Vector2d& right);
  RowError result() const;

 private:
  double sum_ = 0;
  double max_ = 0;
  std::size_t count_ = 0;
};

// Disparities x_left - x_right that the rig has to cover.
struct DisparityRange {
  double min = 0;
  double max = 0;

  // Number of candidates from the whole disparity below `min` to the whole disparity above `max`.
  int needed() const;
};

// The offset that `auto` chooses. It leaves the same room on the near and the far side of `range`, and is
// negative only if `range` is. Throws std::invalid_argument if `range` needs more than `disparities`
// candidates.
int disparity_offset_for(const DisparityRange& range, int disparities);

}  // namespace stereotlm::calib
