#pragma once

#include "calib/rectification.h"
#include "calib/rig_fit.h"

namespace stereotlm::calib {

// The positions of a pair's corners in its rectified pictures.
GridPair rectified(const Rig& rig, const Rectification& rectification, const GridPair& pair);

// Distances between the rows of the same corner in two rectified pictures, which should be 0.
struct RowError {
  double mean_px = 0;  // mean of the absolute values
  double max_px = 0;
  std::size_t corners = 0;
};

// Computes a RowError, corner by corner.
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

  // The number of candidates that cover the range: the whole numbers from floor(min) to ceil(max).
  int needed() const;
};

// The offset that `--disparity-offset auto` chooses. It centres `range` among the candidates, but is not
// below 0 unless `range` is. Throws std::invalid_argument if `range` needs more than `disparities`
// candidates; the message names the options of `calibrate`.
int disparity_offset_for(const DisparityRange& range, int disparities);

}  // namespace stereotlm::calib
