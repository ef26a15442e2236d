#include "calib/grid_pose.h"

#include <Eigen/Cholesky>
#include <opencv2/calib3d.hpp>

#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

using Step = Eigen::Matrix<double, 6, 1>;  // rotation vector (rad), translation (mm)

// The pose from the left picture alone: the starting point of the fit.
Eigen::Isometry3d pose_from_left(const Rig& rig, const std::vector<Eigen::Vector3d>& points,
                                 const Corners& corners) {
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  for (std::size_t i = 0; i < points.size(); ++i) {
    object.emplace_back(points[i].x(), points[i].y(), points[i].z());
    image.emplace_back(corners[i].x(), corners[i].y());
  }
  cv::Vec3d rotation;
  cv::Vec3d translation;
  cv::solvePnP(object, image, to_mat(rig.left.matrix), to_mat(rig.left.distortion), rotation, translation);
  const Eigen::Vector3d axis(rotation[0], rotation[1], rotation[2]);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(axis.norm(), axis.stableNormalized()).toRotationMatrix();
  pose.translation() << translation[0], translation[1], translation[2];
  return pose;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Step& step) {
  const Eigen::Vector3d axis = step.head<3>();
  Eigen::Isometry3d result = pose;
  result.linear() = Eigen::AngleAxisd(axis.norm(), axis.stableNormalized()) * pose.linear();
  result.translation() += step.tail<3>();
  return result;
}

class Fit {
 public:
  Fit(const Rig& rig, const GridShape& shape, const GridPair& pair, const std::vector<bool>& used)
      : rig_(rig) {
    const std::vector<Eigen::Vector3d> points = corner_points(shape);
    for (std::size_t corner = 0; corner < points.size(); ++corner) {
      if (!used[corner]) continue;
      points_.push_back(points[corner]);
      left_.push_back(pair.left[corner]);
      right_.push_back(pair.right[corner]);
    }
  }

  Eigen::Isometry3d solve() const {
    constexpr int kMostSteps = 30;
    constexpr double kCloseEnough = 1e-10;  // radians and millimetres
    Eigen::Isometry3d pose = pose_from_left(rig_, points_, left_);
    for (int i = 0; i < kMostSteps; ++i) {
      const Eigen::MatrixXd slope = derivative(pose);
      const Step step = (slope.transpose() * slope).ldlt().solve(-slope.transpose() * errors(pose));
      pose = moved(pose, step);
      if (step.norm() < kCloseEnough) break;
    }
    return pose;
  }

 private:
  Eigen::VectorXd errors(const Eigen::Isometry3d& pose) const {
    Eigen::VectorXd result(static_cast<Eigen::Index>(4 * points_.size()));
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const SeenPoint seen = seen_by(rig_, pose * points_[i]);
      result.segment<4>(static_cast<Eigen::Index>(4 * i)) << seen.left - left_[i], seen.right - right_[i];
    }
    return result;
  }

  Eigen::MatrixXd derivative(const Eigen::Isometry3d& pose) const {
    constexpr double kDifference = 1e-6;
    Eigen::MatrixXd result(static_cast<Eigen::Index>(4 * points_.size()), 6);
    for (int i = 0; i < 6; ++i) {
      const Step step = Step::Unit(i) * kDifference;
      result.col(i) = (errors(moved(pose, step)) - errors(moved(pose, -step))) / (2 * kDifference);
    }
    return result;
  }

  const Rig& rig_;
  std::vector<Eigen::Vector3d> points_;
  Corners left_;
  Corners right_;
};

}  // namespace

Eigen::Isometry3d grid_pose(const Rig& rig, const GridShape& shape, const GridPair& pair,
                            const std::vector<bool>& used) {
  return Fit(rig, shape, pair, used).solve();
}

}  // namespace stereotlm::calib
