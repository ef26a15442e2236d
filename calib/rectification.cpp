#include "calib/rectification.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace stereotlm::calib {
namespace {

// From camera coordinates of the camera to homogeneous pixels of its rectified picture; what P2's last column adds is the
// distance between the cameras, which does not move the directions of either.
Eigen::Matrix3d to_rectified(const Eigen::Matrix3d& rotation, const Projection& projection) {
  return projection.leftCols<3>() * rotation;
}

}  // namespace

Eigen::Vector2d rectified_pixel(const CameraModel& camera, const Eigen::Matrix3d& rotation,
                                const Projection& projection, const Eigen::Vector2d& pixel) {
  return (to_rectified(rotation, projection) * camera.direction(pixel).homogeneous()).hnormalized();
}

Eigen::Vector2d source_pixel(const CameraModel& camera, const Eigen::Matrix3d& rotation,
                             const Projection& projection, const Eigen::Vector2d& rectified) {
  const Eigen::Matrix3d from_rectified = to_rectified(rotation, projection).inverse();
  return camera.pixel((from_rectified * rectified.homogeneous()).hnormalized());
}

}  // namespace stereotlm::calib
