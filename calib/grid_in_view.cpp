#include "calib/grid_in_view.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace stereotlm::calib {

GridPair rectified(const Rig& rig, const Rectification& rectification, const GridPair& pair) {
  GridPair result;
  for (const Eigen::Vector2d& corner : pair.left) {
    result.left.push_back(rectified_pixel(rig.left, rectification.r1, rectification.p1, corner));
  }
  for (const Eigen::Vector2d& corner : pair.right) {
    result.right.push_back(rectified_pixel(rig.right, rectification.r2, rectification.p2, corner));
  }
  return result;
}

void RowErrors::add(const Eigen::Vector2d& left, const Eigen::Vector2d& right) {
  const double error = std::abs(left.y() - right.y());
  sum_ += error;
  max_ = std::max(max_, error);
  ++count_;
}

RowError RowErrors::result() const {
  return {count_ > 0 ? sum_ / static_cast<double>(count_) : 0, max_, count_};
}

int DisparityRange::needed() const {
  return static_cast<int>(std::ceil(max)) - static_cast<int>(std::floor(min)) + 1;
}

int disparity_offset_for(const DisparityRange& range, int disparities) {
  const int least = static_cast<int>(std::floor(range.min));
  const int room = disparities - range.needed();
  if (room < 0) {
    throw std::invalid_argument("--disparities = " + std::to_string(disparities) + ": must be " +
                                std::to_string(range.needed()) + " or more for the grid's own, " +
                                std::to_string(least) + ".." + std::to_string(least + range.needed() - 1) +
                                "; or --disparity-offset N, for a part of them");
  }
  return std::min(least, std::max(0, least - room / 2));
}

}  // namespace stereotlm::calib
