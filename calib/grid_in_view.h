#pragma once

#include "calib/rectification.h"
#include "calib/rig_fit.h"

namespace stereotlm::calib {

// The corners of a pair, where they are in its rectified pictures.
GridPair rectified(const Rig& rig, const Rectification& rectification, const GridPair& pair);

struct RowError {
  double mean_px = 0;  // of the absolute values
  double max_px = 0;
  std::size_t corners = 0;
};

// Collects how far rows of the same corner lie apart in the two pictures.
class RowErrors {
 public:
  void add(const Eigen::Vector2d& left, const Eigen::Vector2d& right);
  RowError result() const;

 private:
  double sum_ = 0;
  double max_ = 0;
  std::size_t count_ = 0;
};

// Disparities x_left - x_right of what the rig is to see.
struct DisparityRange {
  double min = 0;
  double max = 0;

  // Candidates from the whole disparity below the least to that above the largest.
  int needed() const;
};

// Throws std::invalid_argument if `range` needs more than `disparities` candidates: what `auto` chooses,
// which leaves as much room on its near side as on its far side, and is not below 0 unless it must.
int disparity_offset_for(const DisparityRange& range, int disparities);

}  // namespace stereotlm::calib
