// stereotlm-grid-check measures how right a board's disparities are at the corners of the grid with which its
// rig was calibrated, and how right the distances that follow from them are.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/calibration.h"
#include "calib/depth.h"
#include "calib/grid.h"
#include "calib/rig_fit.h"
#include "models/kernels/gray_image.h"
#include "models/kernels/lr_check.h"
#include "sw/files/whole_file.h"
#include "sw/media/load.h"

namespace stereotlm::bench {
namespace {

using Json = nlohmann::ordered_json;

// Deviations from a known value, in percent of it.
struct Deviations {
  std::vector<double> percent;

  double mean() const {
    return percent.empty() ? 0 : std::accumulate(percent.begin(), percent.end(), 0.0) / count();
  }
  double mean_absolute() const {
    const auto add = [](double sum, double value) { return sum + std::abs(value); };
    return percent.empty() ? 0 : std::accumulate(percent.begin(), percent.end(), 0.0, add) / count();
  }
  double count() const { return static_cast<double>(percent.size()); }
};

// Compares the disparities of a board with a grid that it has seen. The geometric disparity of a corner
// follows from where both cameras see it.
struct GridAssessment {
  std::size_t corners = 0;
  std::size_t right = 0;       // the board's disparity is within kMostDifference of the geometric disparity
  std::size_t wrong = 0;       // the board has another disparity
  std::size_t unanswered = 0;  // the board has no disparity, or the corner is outside its output
  // Deviations of the distances between neighbouring corners from the side of a square: of right corners; of
  // all answered corners; of right corners with their geometric disparities rounded to whole pixels, which is
  // the least error that a board can have.
  Deviations lengths;
  Deviations lengths_of_answered;
  Deviations lengths_floor;
  // Of right corners: the mean distance from the camera, and, in percent of that, the root mean square of
  // their distances from one plane (floor: as above). 0 with fewer than four right corners.
  double distance_mm = 0;
  double plane_percent = 0;
  double plane_floor_percent = 0;
};

constexpr double kMostDifference = 1.5;  // pixels

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

constexpr const char* kUsage =
    "usage: stereotlm-grid-check RIG.yaml RESULT\n"
    "         RESULT: of a run with --calibration RIG.yaml, --save-frames and --source preloaded whose frame "
    "i shows the\n"
    "         i-th pair of the calibration's sources; a JSON object for each pair, and one for all "
    "together\n";

calib::Corners corners_in(const std::string& picture, const calib::GridShape& shape) {
  const calib::GridSearch found = calib::find_grid(media::load_gray(picture).image, shape);
  if (!found.corners) throw std::runtime_error(picture + ": " + found.problem);
  return *found.corners;
}

Json lengths(const Deviations& deviations) {
  return {{"count", deviations.percent.size()},
          {"mean_percent", deviations.mean()},
          {"mean_absolute_percent", deviations.mean_absolute()}};
}

Json to_json(const std::string& name, const GridAssessment& found) {
  return {{"pair", name},
          {"corners", found.corners},
          {"right", found.right},
          {"wrong", found.wrong},
          {"unanswered", found.unanswered},
          {"lengths", lengths(found.lengths)},
          {"lengths_of_answered", lengths(found.lengths_of_answered)},
          {"lengths_floor", lengths(found.lengths_floor)},
          {"distance_mm", found.distance_mm},
          {"plane_percent", found.plane_percent},
          {"plane_floor_percent", found.plane_floor_percent}};
}

void add(Deviations& all, const Deviations& more) {
  all.percent.insert(all.percent.end(), more.percent.begin(), more.percent.end());
}

void run(const std::string& rig, const std::filesystem::path& result) {
  const calib::Calibration calibration = calib::parse_calibration(files::read_whole_file(rig));
  GridAssessment all;
  Json pairs = Json::array();
  for (std::size_t i = 0; i < calibration.sources.size(); ++i) {
    const calib::Source& source = calibration.sources[i];
    calib::GridPair corners = {corners_in(source.left, calibration.grid),
                               corners_in(source.right, calibration.grid)};
    corners.right = calib::ordered_like(corners.left, calibration.grid, corners.right);
    const auto disparity = media::load_gray((result / fmt::format("frames/{:06}.png", i)).string()).image;
    if (disparity.width != calibration.rig.width || disparity.height != calibration.rig.height) {
      throw std::invalid_argument(fmt::format("disparities = {}x{}: must be as large as the pictures, {}x{}",
                                              disparity.width, disparity.height, calibration.rig.width,
                                              calibration.rig.height));
    }
    const GridAssessment found = Assessor(calibration, disparity)
                                     .assess(rectified(calibration.rig, calibration.rectification, corners));
    pairs.push_back(to_json(std::filesystem::path(source.left).filename(), found));
    all.corners += found.corners;
    all.right += found.right;
    all.wrong += found.wrong;
    all.unanswered += found.unanswered;
    add(all.lengths, found.lengths);
    add(all.lengths_of_answered, found.lengths_of_answered);
    add(all.lengths_floor, found.lengths_floor);
    all.distance_mm += found.distance_mm / static_cast<double>(calibration.sources.size());
    all.plane_percent += found.plane_percent / static_cast<double>(calibration.sources.size());
    all.plane_floor_percent += found.plane_floor_percent / static_cast<double>(calibration.sources.size());
  }
  std::puts(Json{{"pairs", pairs}, {"all", to_json("all", all)}}.dump(1).c_str());
}

}  // namespace
}  // namespace stereotlm::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs(stereotlm::bench::kUsage, stderr);
    return 2;
  }
  try {
    stereotlm::bench::run(argv[1], argv[2]);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "stereotlm-grid-check: %s\n", exception.what());
    return 1;
  }
}
