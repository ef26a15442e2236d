#include "calib/certainty.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stereotlm::calib {
namespace {

constexpr int kCamera = 9;       // parameters of a camera
constexpr int kThirdRadial = 8;  // k3 among them
constexpr int kRotation = 18;    // the first of three
constexpr int kTranslation = 21;
using Parameters = Eigen::Matrix<double, kRigParameters, 1>;

// A step of a parameter that changes positions of points by far less than a pixel.
double step_of(int parameter) {
  if (parameter >= kTranslation) return 1e-3;    // mm
  if (parameter >= kRotation) return 1e-6;       // rad
  return parameter % kCamera < 4 ? 1e-3 : 1e-6;  // pixels, coefficients
}

Eigen::Matrix3d turned(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& by) {
  return Eigen::AngleAxisd(by.norm(), by.stableNormalized()).toRotationMatrix() * rotation;
}

Rig changed(Rig rig, int parameter, double by) {
  if (parameter >= kTranslation) {
    rig.translation[parameter - kTranslation] += by;
  } else if (parameter >= kRotation) {
    rig.rotation = turned(rig.rotation, by * Eigen::Vector3d::Unit(parameter - kRotation));
  } else {
    CameraModel& camera = parameter < kCamera ? rig.left : rig.right;
    const int own = parameter % kCamera;
    if (own < 2)
      camera.matrix(own, own) += by;
    else if (own < 4)
      camera.matrix(own - 2, 2) += by;
    else
      camera.distortion[static_cast<std::size_t>(own - 4)] += by;
  }
  return rig;
}

Eigen::Isometry3d changed(Eigen::Isometry3d pose, int parameter, double by) {
  if (parameter < 3)
    pose.linear() = turned(pose.linear(), by * Eigen::Vector3d::Unit(parameter));
  else
    pose.translation()[parameter - 3] += by;
  return pose;
}

// The depth at which the rays of two pixels meet, along the axis of the ideal left camera.
double depth_of(const Rig& rig, const Eigen::Matrix3d& r1, const SeenPoint& seen) {
  const Eigen::Vector3d left = rig.left.direction(seen.left).homogeneous();
  const Eigen::Vector3d right = rig.rotation.transpose() * rig.right.direction(seen.right).homogeneous();
  const Eigen::Vector3d centre = -rig.rotation.transpose() * rig.translation;  // of the right camera
  Eigen::Matrix<double, 3, 2> rays;
  rays << left, -right;
  const Eigen::Vector2d lengths = (rays.transpose() * rays).inverse() * rays.transpose() * centre;
  return (r1 * (lengths[0] * left)).z();
}

}  // namespace

// Gauss-Newton's normal equations of all parameters, from which the poses of the grids are eliminated.
RigCovariance covariance(const RigFit& fit, const GridShape& shape, const std::vector<GridPair>& pairs) {
  constexpr double kOtherK3 = 0.05;  // one sigma of what a k3 may add at the corner of the picture
  const std::vector<Eigen::Vector3d> points = corner_points(shape);
  RigCovariance normal = RigCovariance::Zero();
  double squares = 0;
  int left_over = -kRigParameters;
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    const std::vector<bool>& used = fit.used[pair];
    const auto count = std::count(used.begin(), used.end(), true);
    if (count == 0) continue;
    const Misfit& its = fit.misfits[pair];
    const auto seen = [&](const Rig& rig, const Eigen::Isometry3d& pose) {
      Eigen::VectorXd result(4 * count);
      Eigen::Index row = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (!used[i]) continue;
        const SeenPoint point = seen_by(rig, pose * points[i]);
        result.segment<4>(row) << point.left, point.right;
        row += 4;
      }
      return result;
    };
    Eigen::MatrixXd of_rig(4 * count, kRigParameters);
    for (int i = 0; i < kRigParameters; ++i) {
      const double step = step_of(i);
      of_rig.col(i) =
          (seen(changed(fit.rig, i, step), its.pose) - seen(changed(fit.rig, i, -step), its.pose)) /
          (2 * step);
    }
    Eigen::MatrixXd of_pose(4 * count, 6);
    for (int i = 0; i < 6; ++i) {
      const double step = step_of(kRotation + i);
      of_pose.col(i) =
          (seen(fit.rig, changed(its.pose, i, step)) - seen(fit.rig, changed(its.pose, i, -step))) /
          (2 * step);
    }
    const Eigen::MatrixXd between = of_rig.transpose() * of_pose;
    normal += of_rig.transpose() * of_rig -
              between * (of_pose.transpose() * of_pose).ldlt().solve(between.transpose());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (used[i]) squares += its.left[i] * its.left[i] + its.right[i] * its.right[i];
    }
    left_over += static_cast<int>(4 * count) - 6;
  }
  const double variance = squares / left_over;
  const RigCovariance full = normal;
  std::vector<int> kept;  // k3 of lenses that have none
  if (fit.lens == Lens::kWithoutK3) kept = {kThirdRadial, kCamera + kThirdRadial};
  for (const int k3 : kept) {
    normal.row(k3).setZero();
    normal.col(k3).setZero();
    normal(k3, k3) = 1;
  }
  const Parameters scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const RigCovariance scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  RigCovariance inverse = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  for (const int k3 : kept) inverse(k3, k3) = 0;
  RigCovariance result = variance * inverse;
  for (const int k3 : kept) {
    const CameraModel& camera = k3 < kCamera ? fit.rig.left : fit.rig.right;
    const double sigma = kOtherK3 / std::pow(camera.direction({0, 0}).norm(), 6);
    Parameters change = -inverse * full.col(k3);  // of the other parameters, with this k3
    change[k3] = 1;
    result += sigma * sigma * change * change.transpose();
  }
  return result;
}

Certainty certainty_of(const RigFit& fit, const RigCovariance& covariance) {
  const auto sigma = [&](int parameter) { return std::sqrt(covariance(parameter, parameter)); };
  Certainty result;
  result.alone_rms_px = fit.evidence.alone_rms_px;
  result.rig_rms_px = fit.evidence.rig_rms_px;
  result.tilt_deg = fit.evidence.tilt_deg;
  result.has_fixed_intrinsics = fit.evidence.has_fixed_intrinsics;
  for (const int first : {0, kCamera}) {
    result.focal_sigma_px = std::max({result.focal_sigma_px, sigma(first), sigma(first + 1)});
    result.centre_sigma_px = std::max({result.centre_sigma_px, sigma(first + 2), sigma(first + 3)});
  }
  const Eigen::Vector3d along = fit.rig.translation.normalized();
  result.baseline_sigma_mm = std::sqrt(along.dot(covariance.block<3, 3>(kTranslation, kTranslation) * along));
  result.turn_sigma_deg = kDegrees * std::max({sigma(kRotation), sigma(kRotation + 1), sigma(kRotation + 2)});
  return result;
}

DepthError depth_error(const Rig& rig, const Rectification& rectification, const RigCovariance& covariance,
                       int disparity_offset, double depth_mm) {
  constexpr double kRounding = 0.28867513459481287;  // 1 / sqrt(12): sigma of the rounding to whole numbers
  const Projection& p1 = rectification.p1;
  const Eigen::Vector2d middle((rig.width - 1) / 2.0 + disparity_offset, (rig.height - 1) / 2.0);
  const Eigen::Vector3d ray = p1.leftCols<3>().inverse() * middle.homogeneous();
  const SeenPoint seen = seen_by(rig, rectification.r1.transpose() * (depth_mm * ray));
  Parameters slope;
  for (int i = 0; i < kRigParameters; ++i) {
    const double step = step_of(i);
    slope[i] = (depth_of(changed(rig, i, step), rectification.r1, seen) -
                depth_of(changed(rig, i, -step), rectification.r1, seen)) /
               (2 * step);
  }
  const double focal_times_baseline = -rectification.p2(0, 3);
  return {depth_mm, kRounding * depth_mm * depth_mm / focal_times_baseline,
          std::sqrt(std::max(0.0, slope.dot(covariance * slope)))};
}

}  // namespace stereotlm::calib
