#include "calib/grid_shape.h"

namespace stereotlm::calib {

std::vector<Eigen::Vector3d> corner_points(const GridShape& shape) {
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < shape.rows; ++row) {
    for (int column = 0; column < shape.columns; ++column) {
      points.emplace_back(column * shape.square_mm, row * shape.square_mm, 0);
    }
  }
  return points;
}

}  // namespace stereotlm::calib
