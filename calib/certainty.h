#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/rig_fit.h"

namespace stereotlm::calib {

// The error of a depth in the middle of the rectified left picture, one sigma.
struct DepthError {
  double depth_mm = 0;
  double rounding_mm = 0;     // because the board's disparities are whole numbers
  double calibration_mm = 0;  // because the rig is known only so well
};

// How well the pictures determine a rig. The sigmas follow from the misfits of the corners.
struct Certainty {
  double alone_rms_px = 0;  // Evidence
  double rig_rms_px = 0;
  bool has_fixed_intrinsics = false;
  double focal_sigma_px = 0;       // of a focal length, the largest of both cameras
  double centre_sigma_px = 0;      // of a coordinate of a centre, likewise
  double baseline_sigma_mm = 0;    // of the distance of the cameras
  double turn_sigma_deg = 0;       // of the rotation between the cameras
  double tilt_deg = 0;             // the largest angle between a grid and the picture of the left camera
  std::vector<DepthError> depths;  // nearest, middle and farthest disparity of the board
};

// fx, fy, cx, cy, k1, k2, p1, p2, k3 of the left and of the right camera, the rotation vector (rad) and the
// translation (mm).
constexpr int kRigParameters = 24;
using RigCovariance = Eigen::Matrix<double, kRigParameters, kRigParameters>;

// The covariance of the parameters. A k3 that is taken as 0 may in truth move the corner of the picture by 5
// % of its distance from the centre (one sigma). Throws as CameraModel::direction().
RigCovariance covariance(const RigFit& fit, const GridShape& shape, const std::vector<GridPair>& pairs);

// Without the depths.
Certainty certainty_of(const RigFit& fit, const RigCovariance& covariance);

// At a depth in mm. The column is the middle of the picture of the board, whose left table has this offset.
DepthError depth_error(const Rig& rig, const Rectification& rectification, const RigCovariance& covariance,
                       int disparity_offset, double depth_mm);

}  // namespace stereotlm::calib
