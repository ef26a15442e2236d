#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace stereotlm::calib {

// A chessboard: `columns` x `rows` inner corners, where four squares meet.
struct GridShape {
  int columns = 0;       // 3..100
  int rows = 0;          // 3..100
  double square_mm = 0;  // a side of a square, 1..1000

  int corners() const { return columns * rows; }
};

// Every broken rule, as `field = value: rule`.
std::vector<std::string> problems(const GridShape& shape);

// The inner corners on the chessboard, row by row, z = 0, in mm; the first is the origin.
std::vector<Eigen::Vector3d> corner_points(const GridShape& shape);

// The corners in one picture, in the order of corner_points(), in pixels.
using Corners = std::vector<Eigen::Vector2d>;

// The corners that both cameras see in one position of the grid.
struct GridPair {
  Corners left;
  Corners right;
};

}  // namespace stereotlm::calib
