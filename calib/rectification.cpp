#include "calib/rectification.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace stereotlm::calib {
namespace {

// The matrix from camera coordinates of a camera to homogeneous pixels of its rectified picture. It leaves
// out the last column of P2, which adds the distance between the cameras and does not change directions.
Eigen::Matrix3d to_rectified(const Eigen::Matrix3d& rotation, const Projection& projection) {
  return projection.leftCols<3>() * rotation;
}

}  // namespace

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

}  // namespace stereotlm::calib
