#pragma once

#include <Eigen/Core>

#include "calib/camera_model.h"

namespace stereotlm::calib {

// Two cameras on one bar, with pictures of one size.
struct Rig {
  int width = 0;   // pixels
  int height = 0;  // pixels
  CameraModel left;
  CameraModel right;
  // Camera coordinates of a point: right = rotation * left + translation, mm.
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

// The pixels at which the two cameras see a point, which is in camera coordinates of the left camera.
struct SeenPoint {
  Eigen::Vector2d left;
  Eigen::Vector2d right;
};

SeenPoint seen_by(const Rig& rig, const Eigen::Vector3d& point);

}  // namespace stereotlm::calib
