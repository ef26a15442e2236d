#pragma once

#include <Eigen/Core>
#include <vector>

namespace stereotlm::calib {

// A chessboard: `columns` x `rows` inner corners, where four squares meet.
struct GridShape {
  int columns = 0;
  int rows = 0;
  double square_mm = 0;

  int corners() const { return columns * rows; }
};

// The inner corners on the chessboard, row by row, z = 0, in mm; the first is the origin.
std::vector<Eigen::Vector3d> corner_points(const GridShape& shape);

// Of one picture, in the order of corner_points(), pixels.
using Corners = std::vector<Eigen::Vector2d>;

}  // namespace stereotlm::calib
