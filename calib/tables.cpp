#include "calib/tables.h"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

namespace stereotlm::calib {
namespace {

std::uint32_t entry_at(const Rig& rig, const Eigen::Vector2d& source) {
  const double column = std::floor(source.x() + 0.5);
  const double row = std::floor(source.y() + 0.5);
  const bool is_inside = column >= 0 && column < rig.width && row >= 0 && row < rig.height;
  return is_inside ? kernels::make_entry(static_cast<int>(column), static_cast<int>(row)) : 0;
}

kernels::RectificationTable table(const Rig& rig, const CameraModel& camera, const Eigen::Matrix3d& rotation,
                                  const Projection& projection, int column_offset) {
  kernels::RectificationTable result{rig.width, rig.height, {}};
  for (int row = 0; row < rig.height; ++row) {
    for (int column = 0; column < rig.width; ++column) {
      const Eigen::Vector2d position(column + column_offset, row);
      result.entries.push_back(entry_at(rig, source_pixel(camera, rotation, projection, position)));
    }
  }
  if (const auto found = kernels::problems(result); !found.empty()) {
    throw std::invalid_argument(found.front());
  }
  return result;
}

}  // namespace

TablePair tables(const Rig& rig, const Rectification& rectification, int disparity_offset) {
  return {table(rig, rig.left, rectification.r1, rectification.p1, disparity_offset),
          table(rig, rig.right, rectification.r2, rectification.p2, 0)};
}

}  // namespace stereotlm::calib
