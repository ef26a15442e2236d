#include "calib/rig_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <stdexcept>
#include <string>

#include "calib/opencv_conversions.h"
#include "calib/rig.h"

namespace stereotlm::calib {
namespace {

using Used = std::vector<std::vector<bool>>;

constexpr double kMostMedians = 8;
constexpr double kAlwaysFits = 0.1;  // pixels; a corner with a smaller misfit is never left out
constexpr int kMostRounds = 20;

// The used corners in OpenCV's form, without pairs that have none.
struct Observations {
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> left;
  std::vector<std::vector<cv::Point2f>> right;
};

cv::Point2f to_point(const Eigen::Vector2d& corner) {
  return {static_cast<float>(corner.x()), static_cast<float>(corner.y())};
}

Observations observations(const GridShape& shape, const std::vector<GridPair>& pairs, const Used& used) {
  const std::vector<Eigen::Vector3d> grid = corner_points(shape);
  Observations result;
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    std::vector<cv::Point3f> points;
    std::vector<cv::Point2f> left;
    std::vector<cv::Point2f> right;
    for (std::size_t corner = 0; corner < grid.size(); ++corner) {
      if (!used[pair][corner]) continue;
      points.emplace_back(static_cast<float>(grid[corner].x()), static_cast<float>(grid[corner].y()), 0.0F);
      left.push_back(to_point(pairs[pair].left[corner]));
      right.push_back(to_point(pairs[pair].right[corner]));
    }
    if (points.empty()) continue;
    result.points.push_back(points);
    result.left.push_back(left);
    result.right.push_back(right);
  }
  return result;
}

CameraModel to_camera(const cv::Mat& matrix, const cv::Mat& distortion) {
  CameraModel camera{to_eigen<Eigen::Matrix3d>(matrix), {}, false};
  std::copy_n(distortion.ptr<double>(), distortion.total(), camera.distortion.begin());
  return camera;
}

// The fit of one camera alone, with the pose of the grid in each pair.
struct SingleFit {
  cv::Mat matrix;
  cv::Mat distortion;
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  cv::Mat sigmas;       // of fx, fy, cx, cy and the coefficients, one sigma
  cv::Mat view_rms_px;  // [pair]
  double rms_px = 0;
};

// Runs a step of the fit, and turns an exception of OpenCV into std::runtime_error.
template <typename Fitted>
auto with_refusal(const Fitted& fit) {
  try {
    return fit();
  } catch (const cv::Exception& error) {
    throw std::runtime_error("the cameras cannot be calibrated from these pictures: " + error.err);
  }
}

int flags_of(Lens lens) { return lens == Lens::kWithoutK3 ? cv::CALIB_FIX_K3 : 0; }

// Starts at `guess`. Without one, the result is the better of two fits: OpenCV's own, and one that starts at
// the fit of a lens that has k1 alone. Each finds a wrong minimum now and then.
SingleFit fit_camera(const Observations& seen, const std::vector<std::vector<cv::Point2f>>& corners,
                     cv::Size size, Lens lens, const CameraModel* guess = nullptr) {
  constexpr double kMuchBetter = 0.99;
  const auto fit_from = [&](SingleFit fit, int flags) {
    cv::Mat none;
    fit.rms_px = cv::calibrateCamera(seen.points, corners, size, fit.matrix, fit.distortion, fit.rotations,
                                     fit.translations, fit.sigmas, none, fit.view_rms_px, flags);
    return fit;
  };
  constexpr int kSimple =
      cv::CALIB_FIX_PRINCIPAL_POINT | cv::CALIB_ZERO_TANGENT_DIST | cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3;
  const int guessed = cv::CALIB_USE_INTRINSIC_GUESS | flags_of(lens);
  return with_refusal([&] {
    if (guess != nullptr) {
      SingleFit start;
      start.matrix = to_mat(guess->matrix);
      start.distortion = coefficients_of(*guess);
      return fit_from(start, guessed);
    }
    SingleFit fit = fit_from({}, flags_of(lens));
    SingleFit other = fit_from(fit_from({}, kSimple), guessed);
    return other.rms_px < kMuchBetter * fit.rms_px ? other : fit;
  });
}

Eigen::Isometry3d to_pose(const cv::Mat& rotation, const cv::Mat& translation) {
  cv::Mat matrix;
  cv::Rodrigues(rotation, matrix);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = to_eigen<Eigen::Matrix3d>(matrix);
  pose.translation() = to_eigen<Eigen::Vector3d>(translation);
  return pose;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Where the right camera stands relative to the left one, by each pair alone.
struct Places {
  std::vector<double> errors;     // [pair]: distance from the median of all pairs, mm
  std::vector<double> distances;  // [pair]: of the grid, mm
  Eigen::Isometry3d nearest;      // from the left to the right camera, of the pair with the least error
};

Places places_of(const SingleFit& left, const SingleFit& right) {
  Places result;
  std::vector<Eigen::Isometry3d> places;
  for (std::size_t pair = 0; pair < left.rotations.size(); ++pair) {
    const Eigen::Isometry3d from_grid = to_pose(left.rotations[pair], left.translations[pair]);
    places.push_back(to_pose(right.rotations[pair], right.translations[pair]) * from_grid.inverse());
    result.distances.push_back(from_grid.translation().norm());
  }
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    for (const Eigen::Isometry3d& place : places) along.push_back(place.translation()[axis]);
    middle[axis] = median(along);
  }
  for (const Eigen::Isometry3d& place : places)
    result.errors.push_back((place.translation() - middle).norm());
  const auto least = std::min_element(result.errors.begin(), result.errors.end());
  result.nearest = places[static_cast<std::size_t>(least - result.errors.begin())];
  return result;
}

// Whether most pairs can be of one rig at all.
bool nearly_agree(const Places& places) {
  constexpr double kMostShare = 0.1;  // of the distance of the grid
  return median(places.errors) < kMostShare * median(places.distances);
}

// Returns which corners to use: all corners of the pairs in which the right camera is near its median
// position relative to the left one, and none of the other pairs. A pair whose grid moved between its two
// pictures would spoil the fit to all pairs.
Used pairs_that_agree(const Places& places, std::size_t corners) {
  constexpr double kMostShare = 0.02;  // of the distance of the grid
  const double usual = kMostMedians * median(places.errors);
  Used used;
  for (std::size_t pair = 0; pair < places.errors.size(); ++pair)
    used.emplace_back(corners, places.errors[pair] <= std::max(usual, kMostShare * places.distances[pair]));
  return used;
}

// [pair]: how much worse the rig fits than the cameras alone do.
std::vector<double> ratios_of_pairs(const RigFit& fit, const SingleFit& left, const SingleFit& right) {
  std::vector<double> ratios;
  for (std::size_t pair = 0; pair < fit.misfits.size(); ++pair) {
    const auto view = static_cast<int>(pair);
    ratios.push_back(fit.misfits[pair].rms_px() * std::sqrt(2.0) /
                     std::hypot(left.view_rms_px.at<double>(view), right.view_rms_px.at<double>(view)));
  }
  return ratios;
}

// `ratios` of the pairs: a pair is left out whose rig fits much worse than those of the others.
Used corners_that_fit(const RigFit& fit, const std::vector<double>& ratios) {
  constexpr double kMostRatio = 1.8;  // of the median
  std::vector<double> of_used;
  for (std::size_t pair = 0; pair < fit.used.size(); ++pair) {
    for (std::size_t corner = 0; corner < fit.used[pair].size(); ++corner) {
      if (fit.used[pair][corner]) of_used.push_back(fit.misfits[pair].of_corner(corner));
    }
  }
  const double most = std::max(kAlwaysFits, kMostMedians * median(std::move(of_used)));
  const double usual = median(ratios);
  Used result = fit.used;
  for (std::size_t pair = 0; pair < result.size(); ++pair) {
    std::size_t count = 0;
    for (std::size_t corner = 0; corner < result[pair].size(); ++corner) {
      result[pair][corner] = fit.misfits[pair].of_corner(corner) <= most;
      if (result[pair][corner]) ++count;
    }
    if (2 * count < result[pair].size() || ratios[pair] > kMostRatio * usual)
      result[pair].assign(result[pair].size(), false);
  }
  return result;
}

bool is_used(const std::vector<bool>& pair) {
  return std::find(pair.begin(), pair.end(), true) != pair.end();
}

bool has_few_pairs(const Used& used) {
  return static_cast<std::size_t>(std::count_if(used.begin(), used.end(), is_used)) < kFewestPairs;
}

RigFit fit_once(const GridShape& shape, const std::vector<GridPair>& pairs, const Used& used,
                const Rig& guess, Lens lens, Intrinsics intrinsics = Intrinsics::kFitted) {
  RigFit fit;
  fit.used = used;
  fit.lens = lens;
  fit.rig = solve_rig(shape, pairs, used, guess, lens, intrinsics);
  const std::vector<bool> all(static_cast<std::size_t>(shape.corners()), true);
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    fit.misfits.push_back(misfit(fit.rig, shape, pairs[pair], is_used(used[pair]) ? used[pair] : all));
  }
  return fit;
}

void add_figures(RigFit& fit) {
  double left = 0;
  double right = 0;
  std::size_t count = 0;
  for (std::size_t pair = 0; pair < fit.used.size(); ++pair) {
    const Misfit& its = fit.misfits[pair];
    for (std::size_t corner = 0; corner < fit.used[pair].size(); ++corner) {
      if (!fit.used[pair][corner]) {
        fit.left_out.push_back({pair, corner, its.of_corner(corner)});
        continue;
      }
      left += its.left[corner] * its.left[corner];
      right += its.right[corner] * its.right[corner];
      ++count;
    }
  }
  const auto corners = static_cast<double>(count);
  fit.left_rms_px = std::sqrt(left / corners);
  fit.right_rms_px = std::sqrt(right / corners);
  fit.stereo_rms_px = std::sqrt((left + right) / (2 * corners));
}

Rig guess_of(const SingleFit& left, const SingleFit& right, cv::Size size) {
  return {size.width, size.height, to_camera(left.matrix, left.distortion),
          to_camera(right.matrix, right.distortion)};
}

// Whether a camera has another focal length or centre than its single fit, by more than 3 sigma.
bool is_bent(const CameraModel& camera, const SingleFit& alone) {
  const Eigen::Matrix3d change = camera.matrix - to_eigen<Eigen::Matrix3d>(alone.matrix);
  const double changes[] = {change(0, 0), change(1, 1), change(0, 2), change(1, 2)};
  for (int i = 0; i < 4; ++i) {
    if (!(std::abs(changes[i]) <= 3 * alone.sigmas.at<double>(i))) return true;
  }
  return false;
}

// Each camera fitted by itself to the same corners.
struct SingleFits {
  SingleFit left;
  SingleFit right;

  bool are_bent_by(const Rig& rig) const { return is_bent(rig.left, left) || is_bent(rig.right, right); }
};

SingleFits fit_cameras(const Observations& seen, const Rig& guess, Lens lens) {
  const cv::Size size(guess.width, guess.height);
  return {fit_camera(seen, seen.left, size, lens, &guess.left),
          fit_camera(seen, seen.right, size, lens, &guess.right)};
}

Evidence evidence_of(const SingleFits& alone) {
  Evidence evidence;
  evidence.alone_rms_px = std::max(alone.left.rms_px, alone.right.rms_px);
  for (std::size_t view = 0; view < alone.left.rotations.size(); ++view) {
    const double cosine = to_pose(alone.left.rotations[view], alone.left.translations[view]).linear()(2, 2);
    evidence.tilt_deg = std::max(evidence.tilt_deg, kDegrees * std::acos(std::min(1.0, std::abs(cosine))));
  }
  return evidence;
}

// The rig that has the lenses of the single fits.
RigFit fit_with_fixed_intrinsics(const GridShape& shape, const std::vector<GridPair>& pairs, const Used& used,
                                 const SingleFits& alone, cv::Size size, Lens lens) {
  RigFit fit =
      fit_once(shape, pairs, used, guess_of(alone.left, alone.right, size), lens, Intrinsics::kFixed);
  add_figures(fit);
  fit.evidence = evidence_of(alone);
  fit.evidence.rig_rms_px = fit.stereo_rms_px;
  return fit;
}

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
  cv::solvePnP(object, image, to_mat(rig.left.matrix), coefficients_of(rig.left), rotation, translation);
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

// The pose of the grid, which maps grid coordinates to camera coordinates of the left camera. It minimises
// the squared distances, in the pictures of both cameras, between the used corners as found and their
// positions under this pose (Gauss-Newton).
Eigen::Isometry3d fitted_pose(const Rig& rig, const std::vector<Eigen::Vector3d>& all_points,
                              const GridPair& pair, const std::vector<bool>& used) {
  constexpr int kMostSteps = 30;
  constexpr double kCloseEnough = 1e-10;  // radians and millimetres
  constexpr double kDifference = 1e-6;
  std::vector<Eigen::Vector3d> points;
  Corners left;
  Corners right;
  for (std::size_t corner = 0; corner < all_points.size(); ++corner) {
    if (!used[corner]) continue;
    points.push_back(all_points[corner]);
    left.push_back(pair.left[corner]);
    right.push_back(pair.right[corner]);
  }
  const auto size = static_cast<Eigen::Index>(4 * points.size());
  const auto errors = [&](const Eigen::Isometry3d& pose) {
    Eigen::VectorXd result(size);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const SeenPoint seen = seen_by(rig, pose * points[i]);
      result.segment<4>(static_cast<Eigen::Index>(4 * i)) << seen.left - left[i], seen.right - right[i];
    }
    return result;
  };
  Eigen::Isometry3d pose = pose_from_left(rig, points, left);
  for (int i = 0; i < kMostSteps; ++i) {
    Eigen::MatrixXd slope(size, 6);
    for (int axis = 0; axis < 6; ++axis) {
      const Step part = Step::Unit(axis) * kDifference;
      slope.col(axis) = (errors(moved(pose, part)) - errors(moved(pose, -part))) / (2 * kDifference);
    }
    const Step step = (slope.transpose() * slope).ldlt().solve(-slope.transpose() * errors(pose));
    pose = moved(pose, step);
    if (step.norm() < kCloseEnough) break;
  }
  return pose;
}

}  // namespace

double Misfit::rms_px() const {
  double squares = 0;
  for (const std::vector<double>* side : {&left, &right})
    for (const double distance : *side) squares += distance * distance;
  return std::sqrt(squares / static_cast<double>(left.size() + right.size()));
}

Rig solve_rig(const GridShape& shape, const std::vector<GridPair>& pairs, const Used& used, const Rig& guess,
              Lens lens, Intrinsics intrinsics) {
  const Observations seen = observations(shape, pairs, used);
  return with_refusal([&] {
    cv::Mat m1 = to_mat(guess.left.matrix);
    cv::Mat d1 = coefficients_of(guess.left);
    cv::Mat m2 = to_mat(guess.right.matrix);
    cv::Mat d2 = coefficients_of(guess.right);
    cv::Mat rotation, translation, essential, fundamental;
    constexpr int kMostSteps = 200;
    constexpr double kCloseEnough = 1e-9;
    cv::stereoCalibrate(seen.points, seen.left, seen.right, m1, d1, m2, d2, {guess.width, guess.height},
                        rotation, translation, essential, fundamental,
                        intrinsics == Intrinsics::kFixed ? cv::CALIB_FIX_INTRINSIC
                                                         : cv::CALIB_USE_INTRINSIC_GUESS | flags_of(lens),
                        {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kMostSteps, kCloseEnough});
    return Rig{guess.width,
               guess.height,
               to_camera(m1, d1),
               to_camera(m2, d2),
               to_eigen<Eigen::Matrix3d>(rotation),
               to_eigen<Eigen::Vector3d>(translation)};
  });
}

Misfit misfit(const Rig& rig, const GridShape& shape, const GridPair& pair, const std::vector<bool>& used) {
  const std::vector<Eigen::Vector3d> points = corner_points(shape);
  const Eigen::Isometry3d pose = fitted_pose(rig, points, pair, used);
  Misfit result{pose, {}, {}};
  for (std::size_t corner = 0; corner < points.size(); ++corner) {
    const SeenPoint seen = seen_by(rig, pose * points[corner]);
    result.left.push_back((seen.left - pair.left[corner]).norm());
    result.right.push_back((seen.right - pair.right[corner]).norm());
  }
  return result;
}

RigFit fit_rig(const GridShape& shape, int width, int height, const std::vector<GridPair>& pairs, Lens lens) {
  constexpr double kSuspicious = 1.5;
  const cv::Size size(width, height);
  const auto corners = static_cast<std::size_t>(shape.corners());
  Used used(pairs.size(), std::vector<bool>(corners, true));
  if (has_few_pairs(used))
    throw std::invalid_argument("pairs of pictures = " + std::to_string(pairs.size()) + ": must be " +
                                std::to_string(kFewestPairs) + " or more");
  const Observations all = observations(shape, pairs, used);
  const SingleFit left = fit_camera(all, all.left, size, lens);
  const SingleFit right = fit_camera(all, all.right, size, lens);
  const Places places = places_of(left, right);
  if (const Used agree = pairs_that_agree(places, corners); !has_few_pairs(agree)) used = agree;
  Rig guess = guess_of(left, right, size);
  guess.rotation = places.nearest.linear();
  guess.translation = places.nearest.translation();
  const bool do_agree = nearly_agree(places);
  // OpenCV finds no rig whose cameras are turned by half a turn.
  if (!do_agree || guess.roll_deg() > kMostRoll) {
    RigFit fit;
    fit.rig = guess;
    fit.evidence = evidence_of({left, right});
    fit.evidence.disagreement_mm = do_agree ? 0 : median(places.errors);
    return fit;
  }
  RigFit fit = fit_once(shape, pairs, used, guess, lens);
  bool has_few = false;
  for (int round = 1; round < kMostRounds; ++round) {
    used = corners_that_fit(fit, ratios_of_pairs(fit, left, right));
    has_few = has_few_pairs(used);
    if (has_few || used == fit.used) break;
    fit = fit_once(shape, pairs, used, fit.rig, lens);
  }
  add_figures(fit);
  const SingleFits alone = fit_cameras(observations(shape, pairs, fit.used), guess, lens);
  RigFit kept = fit_with_fixed_intrinsics(shape, pairs, fit.used, alone, size, lens);
  const bool is_bent = alone.are_bent_by(fit.rig);
  Evidence evidence = kept.evidence;
  evidence.has_few_pairs = has_few;
  if (!is_bent) evidence.rig_rms_px = std::min(evidence.rig_rms_px, fit.stereo_rms_px);
  evidence.has_fixed_intrinsics = is_bent && evidence.ratio() >= kSuspicious;
  if (evidence.has_fixed_intrinsics) fit = std::move(kept);
  fit.evidence = evidence;
  return fit;
}

std::optional<RigFit> fit_all(const GridShape& shape, const std::vector<GridPair>& pairs, const Rig& guess) {
  const Used all(pairs.size(), std::vector<bool>(static_cast<std::size_t>(shape.corners()), true));
  const SingleFits alone = fit_cameras(observations(shape, pairs, all), guess, Lens::kFull);
  if (!nearly_agree(places_of(alone.left, alone.right))) return std::nullopt;
  return fit_with_fixed_intrinsics(shape, pairs, all, alone, {guess.width, guess.height}, Lens::kFull);
}

Rectification rectify(const Rig& rig) {
  constexpr double kOnlySeenPixels = 0;
  const cv::Size size(rig.width, rig.height);
  const cv::Mat m1 = to_mat(rig.left.matrix);
  const cv::Mat m2 = to_mat(rig.right.matrix);
  const cv::Mat d1 = coefficients_of(rig.left);
  const cv::Mat d2 = coefficients_of(rig.right);
  const cv::Mat r = to_mat(rig.rotation);
  const cv::Mat t = to_mat(rig.translation);
  cv::Mat r1, r2, p1, p2, q;
  if (rig.left.is_fisheye) {
    cv::fisheye::stereoRectify(m1, d1, m2, d2, size, r, t, r1, r2, p1, p2, q, cv::CALIB_ZERO_DISPARITY, size,
                               kOnlySeenPixels);
  } else {
    cv::stereoRectify(m1, d1, m2, d2, size, r, t, r1, r2, p1, p2, q, cv::CALIB_ZERO_DISPARITY,
                      kOnlySeenPixels);
  }
  return {to_eigen<Eigen::Matrix3d>(r1), to_eigen<Eigen::Matrix3d>(r2), to_eigen<Projection>(p1),
          to_eigen<Projection>(p2), to_eigen<Eigen::Matrix4d>(q)};
}

}  // namespace stereotlm::calib
