#include "calib/rig.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace stereotlm::calib {
namespace {

// A direction bent by the lens, and the derivative of the bent direction.
struct Bent {
  Eigen::Vector2d direction;
  Eigen::Matrix2d derivative;
};

// The derivative of the bent angle by the angle.
double fisheye_slope(const std::array<double, 12>& k, double angle) {
  const double a2 = angle * angle;
  return 1 + a2 * (3 * k[0] + a2 * (5 * k[1] + a2 * (7 * k[2] + a2 * 9 * k[3])));
}

// Whether the radial part of the lens maps directions near this square of a length one to one.
bool is_one_to_one(const std::array<double, 12>& k, double r2) {
  const double above = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double below = 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double slope_above = 1 + r2 * (3 * k[0] + r2 * (5 * k[1] + r2 * 7 * k[4]));  // of r * above, by r
  const double slope_below = 2 * r2 * (k[5] + r2 * (2 * k[6] + r2 * 3 * k[7]));      // of below, times r
  return below > 0 && slope_above * below - above * slope_below > 0;
}

Bent bent_by_fisheye(const std::array<double, 12>& distortion, const Eigen::Vector2d& direction) {
  const double r = direction.norm();
  if (r < 1e-9) return {direction, Eigen::Matrix2d::Identity()};
  const double angle = std::atan(r);
  const double a2 = angle * angle;
  const auto& k = distortion;
  const double bent = angle * (1 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
  const Eigen::Vector2d outwards = direction / r;
  const Eigen::Matrix2d radial = outwards * outwards.transpose();
  return {bent * outwards, fisheye_slope(distortion, angle) / (1 + r * r) * radial +
                               bent / r * (Eigen::Matrix2d::Identity() - radial)};
}

Bent bent(const CameraModel& camera, const Eigen::Vector2d& direction) {
  if (camera.is_fisheye) return bent_by_fisheye(camera.distortion, direction);
  const auto [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4] = camera.distortion;
  const double x = direction.x();
  const double y = direction.y();
  const double r2 = x * x + y * y;
  const double above = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double below = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double radial = above / below;
  // The derivative of `radial` by x is x times this.
  const double slope =
      2 * ((k1 + r2 * (2 * k2 + r2 * 3 * k3)) - radial * (k4 + r2 * (2 * k5 + r2 * 3 * k6))) / below;
  const double prism_x = 2 * (s1 + 2 * s2 * r2);  // likewise of the prism's part of each coordinate
  const double prism_y = 2 * (s3 + 2 * s4 * r2);
  Bent result;
  result.direction = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) + r2 * (s1 + r2 * s2),
                      y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y + r2 * (s3 + r2 * s4)};
  const double cross = x * y * slope + 2 * p1 * x + 2 * p2 * y;
  result.derivative << radial + x * x * slope + 2 * p1 * y + 6 * p2 * x + x * prism_x, cross + y * prism_x,
      cross + x * prism_y, radial + y * y * slope + 6 * p1 * y + 2 * p2 * x + y * prism_y;
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
  for (double r = kStep; r < kMost; r += kStep) {
    if (is_fisheye ? fisheye_slope(distortion, std::atan(r)) <= 0 : !is_one_to_one(distortion, r * r))
      return r - kStep;
  }
  return kMost;
}

std::size_t CameraModel::coefficients() const {
  if (is_fisheye) return 4;
  const auto last =
      std::find_if(distortion.rbegin(), distortion.rend(), [](double each) { return each != 0; });
  const auto used = static_cast<std::size_t>(distortion.rend() - last);
  return used <= 5 ? 5 : used <= 8 ? 8 : 12;
}

Eigen::Vector2d CameraModel::pixel(const Eigen::Vector2d& direction) const {
  return (matrix * bent(*this, direction).direction.homogeneous()).hnormalized();
}

// Uses Newton's method, which starts at the direction that the pixel would have without distortion.
Eigen::Vector2d CameraModel::direction(const Eigen::Vector2d& pixel) const {
  constexpr int kMostSteps = 50;
  constexpr double kCloseEnough = 1e-12;
  const Eigen::Vector2d seen = (matrix.inverse() * pixel.homogeneous()).hnormalized();
  Eigen::Vector2d result = seen;
  for (int step = 0; step < kMostSteps; ++step) {
    const Bent here = bent(*this, result);
    // Where the lens folds the picture over, the determinant of the derivative is no longer positive.
    if (!(here.derivative.determinant() > 0)) break;
    const Eigen::Vector2d error = here.direction - seen;
    if (error.norm() < kCloseEnough) return result;
    result -= here.derivative.inverse() * error;
  }
  throw std::domain_error("pixel (" + std::to_string(pixel.x()) + ", " + std::to_string(pixel.y()) +
                          "): must be seen by the lens: its distortion folds the picture over there");
}

double Rig::roll_deg() const { return kDegrees * std::abs(std::atan2(rotation(1, 0), rotation(0, 0))); }

std::optional<std::string> problem_of(const Rig& rig) {
  constexpr double kLeastBaseline = 1;  // mm
  constexpr double kMostFactor = 1.5;   // of the focal lengths
  const Eigen::Vector3d& t = rig.translation;
  if (t.norm() < kLeastBaseline) {
    return fmt::format(
        "the cameras are {:.2f} mm apart: they must stand in two places: are the pictures of two cameras?",
        t.norm());
  }
  const double factor = rig.left.matrix(0, 0) / rig.right.matrix(0, 0);
  if (std::max(factor, 1 / factor) > kMostFactor) {
    return fmt::format("the focal lengths are {:.0f} and {:.0f} px: two cameras of one kind are needed",
                       rig.left.matrix(0, 0), rig.right.matrix(0, 0));
  }
  const double roll = rig.roll_deg();
  if (roll > kMostRoll) {
    return fmt::format(
        "one camera is turned by {:.0f} degrees about its axis against the other: both must be upright: "
        "turn the camera back, or turn its pictures if all have one size then",
        roll);
  }
  if (std::abs(t.y()) > std::abs(t.x())) {
    return fmt::format(
        "the right camera is {:.1f} mm {} the left one and {:.1f} mm beside it: the cameras must "
        "stand side by side; pictures that are turned by 90 degrees must be turned back",
        std::abs(t.y()), t.y() > 0 ? "above" : "below", std::abs(t.x()));
  }
  if (t.x() > 0) {
    return fmt::format(
        "the cameras are swapped: what should be the left one stands {:.1f} mm to the right of the "
        "other: exchange them (if both cameras are upside down, turn them instead)",
        t.x());
  }
  return std::nullopt;
}

SeenPoint seen_by(const Rig& rig, const Eigen::Vector3d& point) {
  const Eigen::Vector3d to_right = rig.rotation * point + rig.translation;
  return {rig.left.pixel(point.hnormalized()), rig.right.pixel(to_right.hnormalized())};
}

Eigen::Matrix4d disparity_to_depth(const Projection& p1, const Projection& p2) {
  const double focal = p1(0, 0);
  const double baseline = -p2(0, 3) / p2(0, 0);
  return Eigen::Matrix4d{{1, 0, 0, -p1(0, 2)},
                         {0, 1, 0, -p1(1, 2)},
                         {0, 0, 0, focal},
                         {0, 0, 1 / baseline, -(p1(0, 2) - p2(0, 2)) / baseline}};
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

std::string GridShape::text() const {
  return fmt::format("{}x{} {}", columns, rows,
                     pattern == Pattern::kChessboard ? "inner corners" : "circles");
}

Eigen::Vector2d GridShape::extent() const {
  return {pattern == Pattern::kAsymmetricCircles ? 2 * columns - 1 : columns - 1, rows - 1};
}

std::optional<Pattern> pattern_named(const std::string& name) {
  const auto* const found = std::find(kPatternNames.begin(), kPatternNames.end(), name);
  if (found == kPatternNames.end()) return std::nullopt;
  return static_cast<Pattern>(found - kPatternNames.begin());
}

std::vector<std::string> problems(const GridShape& shape) {
  const char* corners_text = shape.pattern == Pattern::kChessboard ? "inner corners" : "circles";
  std::vector<std::string> found;
  const auto check_corners = [&](const char* field, int corners) {
    if (corners < 3 || corners > 100) {
      found.push_back(fmt::format("{} = {}: must be 3..100 {}", field, corners, corners_text));
    }
  };
  check_corners("columns", shape.columns);
  check_corners("rows", shape.rows);
  if (shape.pattern == Pattern::kAsymmetricCircles && shape.rows % 2 == 0) {
    found.push_back(fmt::format(
        "rows = {}: must be odd with asymmetric circles: an even number looks the same upside down, and "
        "OpenCV's search then mistakes the rows",
        shape.rows));
  }
  if (!(shape.square_mm >= 1 && shape.square_mm <= 1000)) {
    found.push_back(fmt::format("square_mm = {}: must be 1..1000", shape.square_mm));
  }
  return found;
}

std::vector<Eigen::Vector3d> corner_points(const GridShape& shape) {
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < shape.rows; ++row) {
    for (int column = 0; column < shape.columns; ++column) {
      const int across = shape.pattern == Pattern::kAsymmetricCircles ? 2 * column + row % 2 : column;
      points.emplace_back(across * shape.square_mm, row * shape.square_mm, 0);
    }
  }
  return points;
}

}  // namespace stereotlm::calib
