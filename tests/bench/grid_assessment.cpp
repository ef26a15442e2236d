#include "tests/bench/grid_assessment.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "calib/calibration.h"
#include "calib/depth.h"
#include "models/kernels/lr_check.h"

namespace stereotlm::test {
namespace {

// A corner by the board's disparity, and by the best whole disparity.
struct MeasuredCorner {
  bool is_right = false;
  std::optional<Eigen::Vector3d> point;  // by the board, if it has a disparity
  std::optional<Eigen::Vector3d> best;   // by the rounded geometric disparity
};

class Assessor {
 public:
  Assessor(const calib::Calibration& calibration, const kernels::GrayImage& disparity)
      : shape_(calibration.grid),
        geometry_{calibration.rectification.q, calibration.disparity_offset},
        disparity_(disparity) {}

  GridAssessment assess(const calib::GridPair& rectified) {
    for (std::size_t i = 0; i < rectified.left.size(); ++i) {
      const Eigen::Vector2d output = rectified.left[i] - Eigen::Vector2d(geometry_.disparity_offset, 0);
      measure(output, output.x() - rectified.right[i].x());
    }
    result_.corners = corners_.size();
    compare_lengths();
    fit_planes();
    return result_;
  }

 private:
  // `geometric` does not include the offset.
  void measure(const Eigen::Vector2d& output, double geometric) {
    MeasuredCorner corner;
    const auto column = static_cast<int>(std::floor(output.x() + 0.5));
    const auto row = static_cast<int>(std::floor(output.y() + 0.5));
    const bool is_inside = column >= 0 && column < disparity_.width && row >= 0 && row < disparity_.height;
    const int found = is_inside ? disparity_.at(column, row) : kernels::kInvalidDisparity;
    if (found == kernels::kInvalidDisparity) {
      ++result_.unanswered;
    } else {
      corner.point = geometry_.point(output.x(), output.y(), found);
      corner.best = geometry_.point(output.x(), output.y(), std::floor(geometric + 0.5));
      corner.is_right = corner.point && corner.best && std::abs(found - geometric) <= kMostDifference;
      ++(corner.is_right ? result_.right : result_.wrong);
    }
    corners_.push_back(corner);
  }

  void compare_lengths() {
    for (int row = 0; row < shape_.rows; ++row) {
      for (int column = 0; column < shape_.columns; ++column) {
        if (column + 1 < shape_.columns) compare(at(column, row), at(column + 1, row));
        if (row + 1 < shape_.rows) compare(at(column, row), at(column, row + 1));
      }
    }
  }

  const MeasuredCorner& at(int column, int row) const {
    return corners_[static_cast<std::size_t>(row) * static_cast<std::size_t>(shape_.columns) +
                    static_cast<std::size_t>(column)];
  }

  void compare(const MeasuredCorner& a, const MeasuredCorner& b) {
    if (!a.point || !b.point) return;
    const auto deviation = [this](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
      return 100 * ((to - from).norm() / shape_.square_mm - 1);
    };
    result_.lengths_of_answered.percent.push_back(deviation(*a.point, *b.point));
    if (!a.is_right || !b.is_right) return;
    result_.lengths.percent.push_back(deviation(*a.point, *b.point));
    result_.lengths_floor.percent.push_back(deviation(*a.best, *b.best));
  }

  void fit_planes() {
    std::vector<Eigen::Vector3d> points;
    std::vector<Eigen::Vector3d> best;
    for (const MeasuredCorner& corner : corners_) {
      if (!corner.is_right) continue;
      points.push_back(*corner.point);
      best.push_back(*corner.best);
    }
    if (points.size() < 4) return;
    for (const Eigen::Vector3d& point : points) result_.distance_mm += point.norm();
    result_.distance_mm /= static_cast<double>(points.size());
    result_.plane_percent = 100 * distance_from_plane(points) / result_.distance_mm;
    result_.plane_floor_percent = 100 * distance_from_plane(best) / result_.distance_mm;
  }

  // Root mean square of the distances from the best plane.
  static double distance_from_plane(const std::vector<Eigen::Vector3d>& points) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : points) middle += point;
    middle /= static_cast<double>(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& point : points) scatter += (point - middle) * (point - middle).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, solver.eigenvalues()(0)) / static_cast<double>(points.size()));
  }

  const calib::GridShape& shape_;
  calib::DepthGeometry geometry_;
  const kernels::GrayImage& disparity_;
  std::vector<MeasuredCorner> corners_;
  GridAssessment result_;
};

}  // namespace

double Deviations::mean() const {
  double sum = 0;
  for (const double value : percent) sum += value;
  return percent.empty() ? 0 : sum / static_cast<double>(percent.size());
}

double Deviations::mean_absolute() const {
  double sum = 0;
  for (const double value : percent) sum += std::abs(value);
  return percent.empty() ? 0 : sum / static_cast<double>(percent.size());
}

GridAssessment assess(const calib::Calibration& calibration, const calib::GridPair& corners,
                      const kernels::GrayImage& disparity) {
  if (disparity.width != calibration.rig.width || disparity.height != calibration.rig.height) {
    throw std::invalid_argument("disparities = " + std::to_string(disparity.width) + "x" +
                                std::to_string(disparity.height) + ": must be as large as the pictures, " +
                                std::to_string(calibration.rig.width) + "x" +
                                std::to_string(calibration.rig.height));
  }
  return Assessor(calibration, disparity)
      .assess(rectified(calibration.rig, calibration.rectification, corners));
}

}  // namespace stereotlm::test
