#include "calib/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "calib/arrangement.h"
#include "calib/depth.h"
#include "calib/grid.h"
#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

// Finds the grids. Skips a pair unless the grid is found in both of its pictures.
void find_grids(const CalibrationRequest& request, CalibrationResult& result) {
  const auto search = [&](const kernels::GrayImage& picture, const std::string& name) {
    GridSearch found = find_grid(picture, request.grid);
    if (!found.corners) result.skipped.push_back(fmt::format("'{}': {}", name, found.problem));
    return std::move(found.corners);
  };
  for (std::size_t i = 0; i < request.pictures.size(); ++i) {
    const PicturePair& pair = request.pictures[i];
    const auto left = search(pair.left, pair.left_name);
    const auto right = search(pair.right, pair.right_name);
    if (!left || !right) continue;
    result.pairs.push_back({i, {*left, ordered_like(*left, request.grid, *right)}, {}});
  }
  if (result.pairs.size() >= kFewestPairs) return;
  std::string reasons;
  for (const std::string& reason : result.skipped) reasons += "\n  " + reason;
  throw std::invalid_argument(fmt::format(
      "pairs with a grid of {}x{} inner corners in both pictures = {} of {}: must be {} or more; an inner "
      "corner is where four squares meet: a board of 10x7 squares has 9x6{}",
      request.grid.columns, request.grid.rows, result.pairs.size(), request.pictures.size(), kFewestPairs,
      reasons));
}

[[noreturn]] void refuse(const std::string& cause) { throw std::invalid_argument("refused: " + cause); }

// Names the pairs that fit worst.
std::string worst_pairs(const CalibrationRequest& request, const CalibrationResult& result,
                        const RigFit& fit) {
  constexpr std::size_t kMost = 3;
  std::vector<std::pair<double, std::size_t>> misfits;
  for (std::size_t i = 0; i < fit.misfits.size(); ++i) {
    double squares = 0;
    for (const std::vector<double>* side : {&fit.misfits[i].left, &fit.misfits[i].right})
      for (const double distance : *side) squares += distance * distance;
    misfits.emplace_back(std::sqrt(squares / (2.0 * request.grid.corners())), i);
  }
  std::sort(misfits.rbegin(), misfits.rend());
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, misfits.size()); ++i) {
    const PicturePair& pair = request.pictures[result.pairs[misfits[i].second].picture];
    text += fmt::format("{}'{}' and '{}' {:.1f} px", i == 0 ? "" : ", ", pair.left_name, pair.right_name,
                        misfits[i].first);
  }
  return text;
}

// The rig does not explain what its cameras see: says what was measured, and why if that is found.
[[noreturn]] void refuse_misfit(const CalibrationRequest& request, const CalibrationResult& result,
                                const RigFit& fit) {
  GridViews views{request.grid, fit.rig.width, fit.rig.height, request.pictures.size(), {}, {}};
  for (const CalibratedPair& pair : result.pairs) {
    views.numbers.push_back(pair.picture);
    views.pairs.push_back(pair.corners);
  }
  const std::string measured = fmt::format("each camera alone fits to {:.2f} px, the rig to {:.1f} px",
                                           fit.evidence.alone_rms_px, fit.evidence.rig_rms_px);
  if (const auto mistake = find_misarrangement(views)) {
    refuse(fmt::format("{}: {}, and to {:.2f} px if that is undone: {}", mistake->cause, measured,
                       mistake->rig_rms_px, mistake->cure));
  }
  refuse(
      fmt::format("the two pictures of a pair do not show the grid at the same place: {}; worst {}: take "
                  "both pictures of a "
                  "pair at the same time, of a grid that stands still, with two cameras on one bar",
                  measured, worst_pairs(request, result, fit)));
}

void check_places(const Rig& rig) {
  const Eigen::Vector3d& t = rig.translation;
  constexpr double kLeastBaseline = 1;  // mm
  constexpr double kMostFactor = 1.5;   // of the focal lengths
  if (t.norm() < kLeastBaseline) {
    refuse(fmt::format(
        "the cameras are {:.2f} mm apart: they must stand in two places: are the pictures of two cameras?",
        t.norm()));
  }
  const double factor = rig.left.matrix(0, 0) / rig.right.matrix(0, 0);
  if (std::max(factor, 1 / factor) > kMostFactor) {
    refuse(
        fmt::format("the focal lengths are {:.0f} and {:.0f} px: two cameras of one kind are needed, and "
                    "grids that are tilted by 20 to 40 degrees, near and far",
                    rig.left.matrix(0, 0), rig.right.matrix(0, 0)));
  }
  const double roll = kDegrees * std::atan2(rig.rotation(1, 0), rig.rotation(0, 0));
  if (std::abs(roll) > 45) {
    refuse(
        fmt::format("one camera is turned by {:.0f} degrees about its axis against the other: both must be "
                    "upright",
                    std::abs(roll)));
  }
  if (std::abs(t.y()) > std::abs(t.x())) {
    refuse(
        fmt::format("the right camera is {:.1f} mm {} the left one and {:.1f} mm beside it: the cameras must "
                    "stand side by side; pictures that are turned by 90 degrees must be turned back",
                    std::abs(t.y()), t.y() > 0 ? "above" : "below", std::abs(t.x())));
  }
  if (t.x() > 0) {
    refuse(fmt::format(
        "the cameras are swapped: what should be the left one stands {:.1f} mm to the right of the "
        "other: exchange left and right pictures (if both cameras are upside down, turn them instead)",
        t.x()));
  }
}

// What no pictures without tilt can tell. Their sigmas are small, and wrong.
void check_tilt(const RigFit& fit, const Certainty& certainty) {
  constexpr double kLeastTilt = 3;    // degrees
  constexpr double kMostSigma = 0.1;  // of the focal length
  const double focal = fit.rig.left.matrix(0, 0);
  if (certainty.tilt_deg >= kLeastTilt && certainty.focal_sigma_px <= kMostSigma * focal) return;
  refuse(fmt::format(
      "the grid is tilted by {:.1f} degrees at most, and one sigma of the focal length, {:.0f} px, "
      "is {:.0f} px: the focal lengths are not determined: take pairs with the grid tilted by 20 "
      "to 40 degrees, near and far",
      certainty.tilt_deg, focal, certainty.focal_sigma_px));
}

// What no offset can mend.
void check_disparities(const Rig& rig, const DisparityRange& range) {
  constexpr int kMost = 254;
  if (range.needed() <= kMost) return;
  const double inwards = kDegrees * std::atan2(rig.rotation(0, 2), rig.rotation(2, 2));
  refuse(fmt::format(
      "the grid's disparities are {:.0f} .. {:.0f}, {} of them, and a board has {} at most: the "
      "cameras are turned by {:.0f} degrees against each other to the side: turn them parallel, or "
      "photograph the grid farther away",
      range.min, range.max, range.needed(), kMost, std::abs(inwards)));
}

// Whether the pictures determine the lens models. A model that does not map directions one to one in the
// whole picture folds it over, which no lens does.
bool lenses_are_determined(const Rig& rig) try {
  for (const CameraModel& lens : {rig.left, rig.right}) {
    for (const int row : {0, rig.height - 1}) {
      for (const int column : {0, rig.width - 1}) lens.direction({column, row});
    }
  }
  return true;
} catch (const std::domain_error&) {
  return false;
}

// Adds the errors of depths at the nearest, the middle and the farthest disparity of the board.
void add_depths(Calibration& made, const RigCovariance& covariance) {
  for (const int disparity : {made.disparities - 1, made.disparities / 2, 1}) {
    const auto depth = depth_in_the_middle(made, disparity);
    if (depth && *depth > 0)
      made.certainty->depths.push_back(
          depth_error(made.rig, made.rectification, covariance, made.disparity_offset, *depth));
  }
}

// Measures the used corners in the rectified pictures.
void measure(const std::vector<CalibratedPair>& pairs, Calibration& made) {
  std::vector<double> errors;
  std::vector<double> disparities;
  for (const CalibratedPair& pair : pairs) {
    const GridPair corners = rectified(made.rig, made.rectification, pair.corners);
    for (std::size_t i = 0; i < pair.used.size(); ++i) {
      if (!pair.used[i]) continue;
      errors.push_back(corners.left[i].y() - corners.right[i].y());
      disparities.push_back(corners.left[i].x() - corners.right[i].x());
    }
  }
  const auto [min, max] = std::minmax_element(disparities.begin(), disparities.end());
  made.quality.row_error = row_error(errors);
  made.quality.disparities = {*min, *max};
}

bool all_inside(const kernels::GrayImage& picture, const Corners& corners) {
  return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
    return corner.x() >= 0 && corner.x() <= picture.width - 1 && corner.y() >= 0 &&
           corner.y() <= picture.height - 1;
  });
}

// The row error of corners that are found in the rectified pictures. Only pairs whose corners all lie in both
// rectified pictures count.
RowError found_again(const CalibrationRequest& request, const CalibrationResult& result) {
  const Calibration& made = result.calibration;
  std::vector<double> errors;
  for (const CalibratedPair& pair : result.pairs) {
    const PicturePair& pictures = request.pictures[pair.picture];
    const kernels::GrayImage left = kernels::rectify(pictures.left, result.tables.left);
    const kernels::GrayImage right = kernels::rectify(pictures.right, result.tables.right);
    GridPair corners = rectified(made.rig, made.rectification, pair.corners);
    for (Eigen::Vector2d& corner : corners.left) corner.x() -= made.disparity_offset;
    if (!all_inside(left, corners.left) || !all_inside(right, corners.right)) continue;
    corners.left = refined(left, request.grid, corners.left);
    corners.right = refined(right, request.grid, corners.right);
    for (std::size_t i = 0; i < pair.used.size(); ++i) {
      if (pair.used[i]) errors.push_back(corners.left[i].y() - corners.right[i].y());
    }
  }
  return row_error(errors);
}

// Measures each pair with a calibration to which the pair did not contribute. If there are more than
// kMostGroups pairs, each calibration leaves out several. Returns nullopt if too few pairs would be left, or
// if the rest determines no calibration.
std::optional<HeldOut> held_out(const CalibrationRequest& request, const RigFit& fit,
                                const std::vector<GridPair>& corners, Lens lens) try {
  constexpr std::size_t kMostGroups = 20;
  std::vector<std::size_t> pairs;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (std::find(fit.used[i].begin(), fit.used[i].end(), true) != fit.used[i].end()) pairs.push_back(i);
  }
  if (pairs.size() <= kFewestPairs) return std::nullopt;
  const std::size_t groups = std::min(kMostGroups, pairs.size());
  std::vector<double> rows;
  double squares = 0;
  for (std::size_t group = 0; group < groups; ++group) {
    auto used = fit.used;
    for (std::size_t i = group; i < pairs.size(); i += groups)
      used[pairs[i]].assign(used[pairs[i]].size(), false);
    const Rig rig = solve_rig(request.grid, corners, used, fit.rig, lens);
    const Rectification rectification = rectify(rig);
    for (std::size_t i = group; i < pairs.size(); i += groups) {
      const std::size_t pair = pairs[i];
      const GridPair its = rectified(rig, rectification, corners[pair]);
      const Misfit distances = misfit(rig, request.grid, corners[pair], fit.used[pair]);
      for (std::size_t corner = 0; corner < fit.used[pair].size(); ++corner) {
        if (!fit.used[pair][corner]) continue;
        rows.push_back(its.left[corner].y() - its.right[corner].y());
        squares += std::pow(distances.left[corner], 2) + std::pow(distances.right[corner], 2);
      }
    }
  }
  return HeldOut{std::sqrt(squares / (2 * static_cast<double>(rows.size()))), row_error(rows)};
} catch (const std::runtime_error&) {
  return std::nullopt;
} catch (const std::domain_error&) {
  return std::nullopt;
}

// The position of the maximum of a parabola through three values, relative to the middle one, which is the
// largest: -0.5..0.5.
double between(double before, double largest, double after) {
  const double bend = before - 2 * largest + after;
  return bend < 0 ? 0.5 * (before - after) / bend : 0;
}

}  // namespace

CalibrationResult calibrate(const CalibrationRequest& request) {
  CalibrationResult result;
  find_grids(request, result);
  std::vector<GridPair> corners;
  for (const CalibratedPair& pair : result.pairs) corners.push_back(pair.corners);
  RigFit fit;
  for (const Lens lens : {Lens::kFull, Lens::kWithoutK3}) {
    const kernels::GrayImage& first = request.pictures.front().left;
    fit = fit_rig(request.grid, first.width, first.height, corners, lens);
    if (lenses_are_determined(fit.rig)) break;
  }
  result.lens = fit.lens;
  const RigCovariance covariance_of_rig = covariance(fit, request.grid, corners);
  const Certainty certainty = certainty_of(fit, covariance_of_rig);
  check_tilt(fit, certainty);
  if (fit.evidence.refutes()) refuse_misfit(request, result, fit);
  check_places(fit.rig);
  if (!lenses_are_determined(fit.rig)) {
    refuse(
        "the lenses are not determined up to the corners of their pictures: the grid must be seen there too");
  }
  result.left_out = fit.left_out;

  Calibration& made = result.calibration;
  made.grid = request.grid;
  made.rig = fit.rig;
  made.rectification = rectify(fit.rig);
  made.disparities = request.disparities;
  for (std::size_t i = 0; i < result.pairs.size(); ++i) {
    CalibratedPair& pair = result.pairs[i];
    pair.used = fit.used[i];
    const PicturePair& pictures = request.pictures[pair.picture];
    made.sources.push_back({pictures.left_name, pictures.right_name,
                            static_cast<std::size_t>(std::count(pair.used.begin(), pair.used.end(), true))});
  }
  Quality& quality = made.quality;
  quality.left_rms_px = fit.left_rms_px;
  quality.right_rms_px = fit.right_rms_px;
  quality.stereo_rms_px = fit.stereo_rms_px;
  measure(result.pairs, made);
  if (!request.disparity_offset) check_disparities(made.rig, quality.disparities);
  made.disparity_offset = request.disparity_offset
                              ? *request.disparity_offset
                              : disparity_offset_for(quality.disparities, request.disparities);
  result.tables = tables(made.rig, made.rectification, made.disparity_offset);
  check_sources(result.tables, made.disparity_offset);
  made.certainty = certainty;
  add_depths(made, covariance_of_rig);
  quality.found_again = found_again(request, result);
  quality.held_out = held_out(request, fit, corners, result.lens);
  return result;
}

MatchedRows matched_rows(const kernels::GrayImage& left, const kernels::GrayImage& right, int disparities) {
  if (left.width != right.width || left.height != right.height) {
    throw std::invalid_argument(fmt::format("right picture = {}x{}: must be as large as the left one, {}x{}",
                                            right.width, right.height, left.width, left.height));
  }
  constexpr int kMostPoints = 150;
  constexpr int kReach = 7;     // pixels of the window to each side of a point
  constexpr int kMostRows = 8;  // rows that are searched above and below
  constexpr float kLeastCorrelation = 0.9F;
  constexpr double kQuality = 0.02;
  constexpr double kDistance = 16;
  std::vector<cv::Point2f> points;
  cv::goodFeaturesToTrack(view(left), points, kMostPoints, kQuality, kDistance);
  const cv::Rect picture(0, 0, left.width, left.height);
  MatchedRows result;
  std::vector<double> errors;
  for (const cv::Point2f& point : points) {
    const int column = cvRound(point.x);
    const int row = cvRound(point.y);
    const cv::Rect window(column - kReach, row - kReach, 2 * kReach + 1, 2 * kReach + 1);
    const cv::Rect searched(window.x - (disparities - 1), window.y - kMostRows,
                            window.width + disparities - 1, window.height + 2 * kMostRows);
    const cv::Rect inside = searched & picture;
    if ((window & picture) != window || inside.height != searched.height || inside.width < window.width)
      continue;
    ++result.points;
    cv::Mat likeness;
    cv::matchTemplate(view(right)(inside), view(left)(window), likeness, cv::TM_CCOEFF_NORMED);
    double largest = 0;
    cv::Point at;
    cv::minMaxLoc(likeness, nullptr, &largest, nullptr, &at);
    if (!(largest >= kLeastCorrelation) || at.y == 0 || at.y == likeness.rows - 1) continue;
    const double rest =
        between(likeness.at<float>(at.y - 1, at.x), largest, likeness.at<float>(at.y + 1, at.x));
    errors.push_back(window.y - (inside.y + at.y + rest));
  }
  result.error = row_error(errors);
  return result;
}

}  // namespace stereotlm::calib
