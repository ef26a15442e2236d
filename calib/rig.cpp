#include "calib/rig.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <stdexcept>
#include <string>

namespace stereotlm::calib {
namespace {

// A direction bent by the lens, and the derivative of the bent direction.
struct Bent {
  Eigen::Vector2d direction;
  Eigen::Matrix2d derivative;
};

Bent bent(const std::array<double, 5>& distortion, const Eigen::Vector2d& direction) {
  const auto [k1, k2, p1, p2, k3] = distortion;
  const double x = direction.x();
  const double y = direction.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope =
      2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3));  // the derivative of `radial` by x is x times this
  Bent result;
  result.direction = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                      y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  const double cross = x * y * slope + 2 * p1 * x + 2 * p2 * y;
  result.derivative << radial + x * x * slope + 2 * p1 * y + 6 * p2 * x, cross,  //
      cross, radial + y * y * slope + 6 * p1 * y + 2 * p2 * x;
  return result;
}

// The matrix from camera coordinates of a camera to homogeneous pixels of its rectified picture. It leaves
// out the last column of P2, which adds the distance between the cameras and does not change directions.
Eigen::Matrix3d to_rectified(const Eigen::Matrix3d& rotation, const Projection& projection) {
  return projection.leftCols<3>() * rotation;
}

}  // namespace

double CameraModel::widest() const {
  constexpr double kStep = 1e-3;
  constexpr double kMost = 10;
  const auto [k1, k2, p1, p2, k3] = distortion;
  for (double r = kStep; r < kMost; r += kStep) {
    const double r2 = r * r;
    if (1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * 7 * k3)) <= 0) return r - kStep;
  }
  return kMost;
}

Eigen::Vector2d CameraModel::pixel(const Eigen::Vector2d& direction) const {
  return (matrix * bent(distortion, direction).direction.homogeneous()).hnormalized();
}

// Uses Newton's method, which starts at the direction that the pixel would have without distortion.
Eigen::Vector2d CameraModel::direction(const Eigen::Vector2d& pixel) const {
  constexpr int kMostSteps = 50;
  constexpr double kCloseEnough = 1e-12;
  const Eigen::Vector2d seen = (matrix.inverse() * pixel.homogeneous()).hnormalized();
  Eigen::Vector2d result = seen;
  for (int step = 0; step < kMostSteps; ++step) {
    const Bent here = bent(distortion, result);
    // Where the lens folds the picture over, the determinant of the derivative is no longer positive.
    if (!(here.derivative.determinant() > 0)) break;
    const Eigen::Vector2d error = here.direction - seen;
    if (error.norm() < kCloseEnough) return result;
    result -= here.derivative.inverse() * error;
  }
  throw std::domain_error("pixel (" + std::to_string(pixel.x()) + ", " + std::to_string(pixel.y()) +
                          "): must be seen by the lens: its distortion folds the picture over there");
}

SeenPoint seen_by(const Rig& rig, const Eigen::Vector3d& point) {
  const Eigen::Vector3d to_right = rig.rotation * point + rig.translation;
  return {rig.left.pixel(point.hnormalized()), rig.right.pixel(to_right.hnormalized())};
}

Eigen::Vector2d rectified_pixel(const CameraModel& camera, const Eigen::Matrix3d& rotation,
                                const Projection& projection, const Eigen::Vector2d& pixel) {
  return (to_rectified(rotation, projection) * camera.direction(pixel).homogeneous()).hnormalized();
}

SourcePixels::SourcePixels(const CameraModel& camera, const Eigen::Matrix3d& rotation,
                           const Projection& projection)
    : camera_(camera),
      from_rectified_(to_rectified(rotation, projection).inverse()),
      widest_(camera.widest()) {}

std::optional<Eigen::Vector2d> SourcePixels::at(const Eigen::Vector2d& rectified) const {
  const Eigen::Vector3d ray = from_rectified_ * rectified.homogeneous();
  if (!(ray.z() > 0)) return std::nullopt;
  const Eigen::Vector2d direction = ray.hnormalized();
  if (direction.norm() > widest_) return std::nullopt;
  return camera_.pixel(direction);
}

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
