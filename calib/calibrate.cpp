#include "calib/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "calib/depth.h"
#include "calib/determine_rig.h"
#include "calib/grid.h"
#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

// Finds the grids, in both pictures of a pair at a time. Skips a pair unless the grid is found in both.
void find_grids(const CalibrationRequest& request, CalibrationResult& result) {
  std::size_t searched = 0;
  const auto report = [&](const PicturePair& pair, bool is_left, const GridSearch& found) {
    const char* half = pair.left_name != pair.right_name ? "" : is_left ? " (left half)" : " (right half)";
    const std::string text = fmt::format("'{}'{}: {}", is_left ? pair.left_name : pair.right_name, half,
                                         found.corners ? "found" : found.problem);
    if (!found.corners) result.skipped.push_back(text);
    ++searched;
    if (request.progress) request.progress(searched, text);
  };
  for (std::size_t i = 0; i < request.pictures.size(); ++i) {
    const PicturePair& pair = request.pictures[i];
    auto search = std::async(std::launch::async, [&] { return find_grid(pair.left, request.grid); });
    const GridSearch right = find_grid(pair.right, request.grid);
    const GridSearch left = search.get();
    report(pair, true, left);
    report(pair, false, right);
    if (!left.corners || !right.corners) continue;
    result.pairs.push_back(
        {i, {*left.corners, ordered_like(*left.corners, request.grid, *right.corners)}, {}});
  }
  if (result.pairs.size() >= kFewestPairs) return;
  std::string reasons;
  for (const std::string& reason : result.skipped) reasons += "\n  " + reason;
  const char* hint = request.grid.pattern != Pattern::kChessboard
                         ? ""
                         : "; an inner corner is where four squares meet: a board of 10x7 squares has 9x6";
  throw std::invalid_argument(fmt::format(
      "pairs with a grid of {} in both pictures = {} of {}: must be {} or more{}{}", request.grid.text(),
      result.pairs.size(), request.pictures.size(), kFewestPairs, hint, reasons));
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
// rectified pictures, and are found there, count.
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
    const auto found_left = found_near(left, request.grid, corners.left);
    const auto found_right = found_near(right, request.grid, corners.right);
    if (!found_left || !found_right) continue;
    for (std::size_t i = 0; i < pair.used.size(); ++i) {
      if (pair.used[i]) errors.push_back((*found_left)[i].y() - (*found_right)[i].y());
    }
  }
  return row_error(errors);
}

// Measures each pair with a calibration to which the pair did not contribute. If there are more than
// kMostGroups pairs, each calibration leaves out several. Returns nullopt if too few pairs would be left, or
// if the rest determines no calibration.
std::optional<HeldOut> held_out(const CalibrationRequest& request, const RigFit& fit,
                                const std::vector<GridPair>& corners) try {
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
    const Rig rig = solve_rig(request.grid, corners, used, fit.rig, fit.lens,
                              fit.evidence.has_fixed_intrinsics ? Intrinsics::kFixed : Intrinsics::kFitted);
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

// How much a pattern is like each place of a picture: its correlation.
struct Likeness {
  cv::Mat map;         // by the place of the pattern's top left pixel
  double largest = 0;  // in the map
  double second = 0;   // the largest that is not beside the largest
  cv::Point at;        // of the largest
};

Likeness likeness_of(const cv::Mat& pattern, const cv::Mat& picture) {
  constexpr int kBeside = 3;  // pixels
  Likeness result;
  cv::matchTemplate(picture, pattern, result.map, cv::TM_CCOEFF_NORMED);
  cv::minMaxLoc(result.map, nullptr, &result.largest, nullptr, &result.at);
  cv::Mat others = result.map.clone();
  const cv::Rect beside(result.at.x - kBeside, result.at.y - kBeside, 2 * kBeside + 1, 2 * kBeside + 1);
  others(beside & cv::Rect({0, 0}, others.size())) = -1;
  cv::minMaxLoc(others, nullptr, &result.second);
  return result;
}

}  // namespace

CalibrationResult calibrate(const CalibrationRequest& request) {
  CalibrationResult result;
  find_grids(request, result);
  const kernels::GrayImage& first = request.pictures.front().left;
  GridViews views{request.grid, first.width, first.height, request.pictures.size(), {}, {}, {}};
  for (const CalibratedPair& pair : result.pairs) {
    const PicturePair& pictures = request.pictures[pair.picture];
    views.numbers.push_back(pair.picture);
    views.names.push_back(fmt::format("'{}' and '{}'", pictures.left_name, pictures.right_name));
    views.pairs.push_back(pair.corners);
  }
  const DeterminedRig determined = determine_rig(views);
  const RigFit& fit = determined.fit;
  result.lens = fit.lens;
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
  made.disparity_offset = request.disparity_offset
                              ? *request.disparity_offset
                              : disparity_offset_for(quality.disparities, request.disparities);
  result.tables = tables(made.rig, made.rectification, made.disparity_offset);
  check_sources(result.tables, made.disparity_offset);
  made.certainty = determined.certainty;
  add_depths(made, determined.covariance);
  quality.found_again = found_again(request, result);
  quality.held_out = held_out(request, fit, views.pairs);
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
  constexpr double kLeastCorrelation = 0.9;
  constexpr double kMostAlike = 0.8;      // correlation with another place of the left picture
  constexpr double kClearlyBetter = 0.6;  // what the best place lacks, as a part of what the second one lacks
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
    const cv::Mat pattern = view(left)(window);
    const cv::Rect around(inside.x, inside.y, inside.width + disparities - 1, inside.height);
    if (likeness_of(pattern, view(left)(around & picture)).second > kMostAlike) continue;
    const Likeness found = likeness_of(pattern, view(right)(inside));
    const bool is_found = found.largest >= kLeastCorrelation && found.at.y > 0 && found.at.y < 2 * kMostRows;
    if (is_found && 1 - found.largest > kClearlyBetter * (1 - found.second)) continue;
    ++result.points;
    if (!is_found) continue;
    const auto at = [&found](int place) { return found.map.at<float>(place, found.at.x); };
    const double rest = between(at(found.at.y - 1), found.largest, at(found.at.y + 1));
    errors.push_back(window.y - (inside.y + found.at.y + rest));
    result.in_row += std::abs(found.at.y - kMostRows) <= 1 ? 1U : 0U;
  }
  result.error = row_error(errors);
  return result;
}

}  // namespace stereotlm::calib
