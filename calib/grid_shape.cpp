#include "calib/grid_shape.h"

#include <fmt/format.h>

namespace stereotlm::calib {

std::vector<std::string> problems(const GridShape& shape) {
  std::vector<std::string> found;
  const auto check_corners = [&found](const char* field, int corners) {
    if (corners < 3 || corners > 100) {
      found.push_back(fmt::format("{} = {}: must be 3..100 inner corners", field, corners));
    }
  };
  check_corners("columns", shape.columns);
  check_corners("rows", shape.rows);
  if (!(shape.square_mm >= 1 && shape.square_mm <= 1000)) {
    found.push_back(fmt::format("square_mm = {}: must be 1..1000", shape.square_mm));
  }
  return found;
}

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
