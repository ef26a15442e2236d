#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/rig.h"

namespace stereotlm::calib {

using Projection = Eigen::Matrix<double, 3, 4>;

// Two ideal cameras that replace the cameras of a rig. They have parallel axes, the same focal length and the
// same principal point, and see a point in the same row. The names are those of OpenCV's stereoRectify.
struct Rectification {
  // r1 (r2) maps camera coordinates of the left (right) camera to camera coordinates of its ideal camera.
  Eigen::Matrix3d r1 = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d r2 = Eigen::Matrix3d::Identity();
  // p1 (p2) maps camera coordinates of the ideal left camera to pixels of the left (right) rectified picture.
  Projection p1 = Projection::Zero();
  Projection p2 = Projection::Zero();
  // q maps (column, row, true disparity, 1) of the rectified left picture to homogeneous camera coordinates
  // of the ideal left camera, in mm.
  Eigen::Matrix4d q = Eigen::Matrix4d::Zero();
};

// Rectifies a rig. The rectified pictures have the size of the rig's pictures, and contain only pixels that
// the cameras saw.
Rectification rectify(const Rig& rig);

// Maps a pixel of a camera's picture to its position in the rectified picture. `rotation` and `projection`
// are r1 and p1, or r2 and p2. Throws as CameraModel::direction() does.
Eigen::Vector2d rectified_pixel(const CameraModel& camera, const Eigen::Matrix3d& rotation,
                                const Projection& projection, const Eigen::Vector2d& pixel);

// The inverse of rectified_pixel(): maps a position of the rectified picture to the pixel of the camera's
// picture that is seen there. at() returns nullopt if the position is behind the camera, or beyond the view
// of its lens (CameraModel::widest()).
class SourcePixels {
 public:
  SourcePixels(const CameraModel& camera, const Eigen::Matrix3d& rotation, const Projection& projection);
  std::optional<Eigen::Vector2d> at(const Eigen::Vector2d& rectified) const;

 private:
  CameraModel camera_;
  Eigen::Matrix3d from_rectified_;
  double widest_;
};

}  // namespace stereotlm::calib
