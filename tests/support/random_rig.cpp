#include "tests/support/random_rig.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "calib/calibration.h"
#include "calib/grid.h"
#include "calib/split_mix.h"

namespace stereotlm::test {
namespace {

using namespace calib;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;

double radians(double degrees) { return degrees * (kPi / 180); }

// The direction of the vector is the axis of the turn, its length the angle.
Matrix3d turned(const Vector3d& degrees) {
  return Eigen::AngleAxisd(radians(degrees.norm()), degrees.stableNormalized()).toRotationMatrix();
}

Vector3d uniform(SplitMix& random, const Vector3d& most) {
  return most.unaryExpr([&random](double each) { return random.between(-each, each); });
}

int whole(SplitMix& random, int low, int high) {  // low..high, both included
  return low + static_cast<int>(random.next() % static_cast<std::uint64_t>(high - low + 1));
}

std::size_t any(SplitMix& random, std::size_t count) { return random.next() % count; }

int sign(SplitMix& random) { return whole(random, 0, 1) == 0 ? 1 : -1; }

// Independent numbers of a standard deviation (Box and Muller, 1958).
Vector3d gaussian(SplitMix& random, double deviation) {
  return Vector3d::NullaryExpr([&] {
    const double radius = std::sqrt(-2 * std::log(1 - random.between(0, 1)));
    return deviation * radius * std::cos(random.between(0, 2 * kPi));
  });
}

// Draws until there is a value.
template <typename Draw>
auto first_of(int tries, const Draw& draw) {
  for (int attempt = 0; attempt < tries; ++attempt) {
    if (const auto drawn = draw()) return *drawn;
  }
  throw std::domain_error("random rig: none in " + std::to_string(tries) + " draws");
}

Isometry3d pose_of(const GridShape& grid, const Matrix3d& rotation, const Vector3d& middle) {
  const Vector3d half = grid.square_mm / 2 * Vector3d(grid.columns - 1, grid.rows - 1, 0);
  return Eigen::Translation3d(middle - rotation * half) * Isometry3d(rotation);
}

// What the cameras of a rig see. Throws std::domain_error unless the lenses map directions one to one over
// the pictures, and a tenth beyond.
class Views {
 public:
  explicit Views(const Rig& rig)
      : rig_(rig), from_left_(Eigen::Translation3d(rig.translation) * Isometry3d(rig.rotation)) {
    constexpr int kSteps = 20;
    for (int i = 0; i < (kSteps + 1) * (kSteps + 1); ++i) {
      const Vector2d share = Vector2d(i % (kSteps + 1), i / (kSteps + 1)) / kSteps;
      const Vector2d pixel = share.cwiseProduct(last_);
      directions.push_back(rig.left.direction(pixel));
      if (std::min(widest_[0] / directions.back().norm(), widest_[1] / rig.right.direction(pixel).norm()) <
          1.1)
        throw std::domain_error("random rig: the lens folds the picture over");
    }
  }

  // The directions from the left camera that the right one sees too, if all is at this depth.
  std::vector<Vector2d> shared(double depth) const {
    std::vector<Vector2d> result;
    for (const Vector2d& direction : directions) {
      if (pixel(1, from_left_ * (depth * direction.homogeneous()), 0)) result.push_back(direction);
    }
    return result;
  }

  // The corners of a grid that stands at one pose in the left exposure and at another in the right one.
  // Nullopt unless a detector would find all of them in both pictures.
  std::optional<GridPair> grid(const GridShape& shape, const Isometry3d& in_left,
                               const Isometry3d& in_right) const {
    GridPair pair;
    if (!add_corners(0, shape, in_left, pair.left)) return std::nullopt;
    if (!add_corners(1, shape, from_left_ * in_right, pair.right)) return std::nullopt;
    return pair;
  }

  std::vector<Vector2d> directions;  // all over the left picture

 private:
  // Where the left (0) or the right (1) camera sees a point of its camera coordinates.
  std::optional<Vector2d> pixel(std::size_t side, const Vector3d& point, double border) const {
    if (!(point.z() > 0) || point.hnormalized().norm() > widest_[side]) return std::nullopt;
    const Vector2d pixel = (side == 0 ? rig_.left : rig_.right).pixel(point.hnormalized());
    if (std::min(pixel.minCoeff(), (last_ - pixel).minCoeff()) < border) return std::nullopt;
    return pixel;
  }

  bool add_corners(std::size_t side, const GridShape& shape, const Isometry3d& pose, Corners& found) const {
    constexpr double kBorder = 4;        // pixels
    constexpr double kNearest = 5;       // pixels between neighbours
    constexpr double kObliquest = 0.34;  // cosine of 70 degrees between line of sight and normal
    const auto columns = static_cast<std::size_t>(shape.columns);
    for (const Vector3d& corner : corner_points(shape)) {
      const Vector3d point = pose * corner;
      const auto at = pixel(side, point, kBorder);
      const std::size_t number = found.size();
      if (!at || point.normalized().dot(pose.linear().col(2)) < kObliquest ||
          (number % columns != 0 && (*at - found.back()).norm() < kNearest) ||
          (number >= columns && (*at - found[number - columns]).norm() < kNearest))
        return false;
      found.push_back(*at);
    }
    return true;
  }

  Rig rig_;
  Isometry3d from_left_;
  Vector2d last_{rig_.width - 1, rig_.height - 1};  // pixel
  std::array<double, 2> widest_{rig_.left.widest(), rig_.right.widest()};
};

// How a rig is drawn. Lengths are shares of the baseline, angles in degrees.
struct Arrangement {
  double most_turn = 8;
  double least_tilt = 15;
  double most_tilt = 40;
  double farthest = 2;  // times the nearest distance
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d place = Vector3d::UnitX();  // of the right camera
  bool is_sound = true;                // large overlap, and disparities that a board can hold
};

// `sign`: which way a quarter turn goes, and whether a camera stands above or below.
Arrangement arrangement_of(Fault fault, double sign) {
  Arrangement result;
  if (fault == Fault::kFrontal) result = {0, 0, 0, 1};
  if (fault == Fault::kHardlyTilted) result = {0, 0, 5, 1.07};
  if (fault == Fault::kRolled) result.rotation = turned({0, 0, sign * 90});
  if (fault == Fault::kVertical) result.place = sign * Vector3d::UnitY();
  if (fault == Fault::kTurnedFar) {  // the right camera is as far in front of the left one as beside it
    result.rotation = turned({-4, 22, 16});
    result.place = result.rotation.transpose() * Vector3d(295, -15, -286).normalized();
  }
  result.is_sound = result.rotation.isIdentity() && result.place == Vector3d::UnitX();
  return result;
}

// A lens that sees the angle a at the distance tan(s * a) / s from the middle. With s = 1 straight lines stay
// straight. The smaller s is, the more the lens bends them (barrel). The polynomial is fitted to this up to
// the corners of the picture, and a tenth beyond.
CameraModel random_camera(SplitMix& random, const Rig& rig, double angle, double s, double focal_factor) {
  const auto bent = [s](double r) { return std::tan(s * std::atan(r)) / s; };
  const double half = bent(std::tan(radians(angle / 2)));
  const double fx = focal_factor * (rig.width / 2.0) / half;
  const double corner = 1.06 * half * std::hypot(1, 1.0 * rig.height / rig.width);
  constexpr int kSamples = 50;
  const double most = 1.1 * std::tan(std::min(radians(85), std::atan(s * corner) / s));
  const Eigen::ArrayXd r = Eigen::ArrayXd::LinSpaced(kSamples, most / kSamples, most);
  Eigen::MatrixX3d powers(kSamples, 3);
  powers << r.pow(3), r.pow(5), r.pow(7);
  const Vector3d k = powers.colPivHouseholderQr().solve((r.unaryExpr(bent) - r).matrix());
  const Vector3d off = uniform(random, {0.03, 0.03, 0.004});
  const Vector3d tangential = uniform(random, {0.001, 0.001, 0});
  CameraModel camera;
  camera.matrix << fx, 0, (rig.width - 1) / 2.0 + off.x() * rig.width,       //
      0, fx * (1 + off.z()), (rig.height - 1) / 2.0 + off.y() * rig.height,  //
      0, 0, 1;
  camera.distortion = {k[0], k[1], tangential[0], tangential[1], k[2]};
  return camera;
}

// The grid goes from the middle of the common view towards a border. At the first four positions, and at
// every second of the others, it goes nearly as far as it can. The directions in which it goes and leans
// depend on the number of the position, so that they differ.
Isometry3d random_pose(SplitMix& random, const Views& views, const FaultyRig& made, const Arrangement& its,
                       double near) {
  const auto number = static_cast<int>(made.poses.size());
  return first_of(30, [&]() -> std::optional<Isometry3d> {
    const double depth = near * random.between(1, its.farthest);
    const double goes = kPi / 4 * (2 * number + 1) + random.between(-0.6, 0.6);
    const double leans = 1.7 * number + random.between(-0.6, 0.6);
    const double tilt = random.between(its.least_tilt, its.most_tilt);
    const Matrix3d rotation = turned(tilt * Vector3d(std::cos(leans), std::sin(leans), 0)) *
                              turned({0, 0, random.between(-12, 12)});
    const double in_right = (made.rig.rotation * rotation)(2, 2);
    if (its.is_sound && in_right > std::cos(radians(its.least_tilt))) return std::nullopt;
    const std::vector<Vector2d> shared = views.shared(depth);
    Vector2d middle = std::accumulate(shared.begin(), shared.end(), Vector2d(0, 0));
    if (!shared.empty()) middle /= static_cast<double>(shared.size());
    const auto at = [&](double way) {
      const Vector2d direction = middle + way * Vector2d(std::cos(goes), 0.7 * std::sin(goes));
      return pose_of(made.grid, rotation, depth * direction.homogeneous());
    };
    const auto is_seen = [&](double way) { return views.grid(made.grid, at(way), at(way)).has_value(); };
    if (!is_seen(0)) return std::nullopt;
    double seen = 0;
    for (double step = 2; step > 1e-3; step /= 2) {
      if (is_seen(seen + step)) seen += step;
    }
    const double way = seen * random.between(number < 4 || number % 2 == 0 ? 0.9 : 0, 1);
    return is_seen(way) ? std::optional(at(way)) : std::nullopt;
  });
}

void check_disparities(const FaultyRig& made) {
  constexpr int kMostCandidates = 254;
  constexpr int kMostOffset = 2048;
  const Rectification rectification = rectify(made.rig);
  DisparityRange range{kMostOffset, -kMostOffset};
  for (const GridPair& pair : made.pairs) {
    const GridPair flat = rectified(made.rig, rectification, pair);
    for (std::size_t i = 0; i < flat.left.size(); ++i) {
      range.min = std::min(range.min, flat.left[i].x() - flat.right[i].x());
      range.max = std::max(range.max, flat.left[i].x() - flat.right[i].x());
    }
  }
  if (std::abs(disparity_offset_for(range, kMostCandidates)) > kMostOffset)
    throw std::domain_error("random rig: no board has this offset");
}

// Nullopt if a rule is broken: a lens folds the picture over, no pose is found, or no board can hold the
// disparities.
std::optional<FaultyRig> try_rig(SplitMix& random, double angle, const Arrangement& its) try {
  FaultyRig made;
  Rig& rig = made.rig;
  GridShape& grid = made.grid;
  rig.width = 4 * whole(random, 80, 320);
  rig.height = std::clamp(static_cast<int>(rig.width * random.between(0.5625, 0.8)), 240, 960);
  const double s = random.between(0.5, 0.97);
  const double right_s = random.about(s, 0.02);
  const double right_focal = random.about(1, 0.02);
  rig.left = random_camera(random, rig, angle, s, 1);
  rig.right = random_camera(random, rig, angle, right_s, right_focal);
  const double baseline = random.between(40, 400);
  const Vector3d about_it = its.place + uniform(random, {0, 0.02, 0.02});
  rig.rotation = turned(uniform(random, Vector3d::Constant(its.most_turn))) * its.rotation;
  rig.translation = -rig.rotation * (baseline * about_it.normalized());

  const Views views(rig);
  const double focal = rig.left.matrix(0, 0);
  const double near = focal * baseline / (random.between(0.06, 0.3) * rig.width);
  for (const double depth : {near, near * its.farthest}) {
    if (its.is_sound && 2 * views.shared(depth).size() < views.directions.size()) return std::nullopt;
  }
  grid.columns = whole(random, 5, 11);
  grid.rows = whole(random, 4, 8);
  const double middle = near * (1 + its.farthest) / 2;
  grid.square_mm = random.between(0.3, 0.55) * middle / focal *
                   std::min(1.0 * rig.width / (grid.columns - 1), 1.0 * rig.height / (grid.rows - 1));
  if (!problems(grid).empty()) return std::nullopt;
  for (int left = whole(random, 6, 20); left > 0; --left) {
    made.poses.push_back(random_pose(random, views, made, its, near));
    made.pairs.push_back(*views.grid(grid, made.poses.back(), made.poses.back()));
  }
  if (its.is_sound) check_disparities(made);
  return made;
} catch (const std::logic_error&) {
  return std::nullopt;
}

// What goes wrong before the pictures are taken: in the right exposure the grid is elsewhere, or the detector
// counts from its next row or column. Both pictures still show all of it. The movement (standard deviations)
// grows until it is `least_px`.
void spoil_scene(SplitMix& random, FaultyRig& made, Fault fault, double mm, double degrees, double least_px) {
  const Views views(made.rig);
  const auto elsewhere = [&](std::size_t pair, const Isometry3d& pose) {
    return views.grid(made.grid, made.poses[pair], pose);
  };
  if (fault == Fault::kOneMiscounted) {
    std::size_t pair = 0;
    const GridPair wrong = first_of(1000, [&] {
      pair = any(random, made.pairs.size());
      Vector3d step = Vector3d::Zero();
      step[whole(random, 0, 1)] = sign(random) * made.grid.square_mm;
      return elsewhere(pair, made.poses[pair] * Eigen::Translation3d(step));
    });
    made.pairs[pair] = wrong;
    made.bad_pairs = {pair};
  }
  const bool is_some = fault == Fault::kSomeMoved;
  if (!is_some && fault != Fault::kMoved && fault != Fault::kMovedLittle) return;
  std::vector<std::size_t> moved;
  for (std::size_t pair = is_some ? any(random, 6) : 0; pair < made.pairs.size(); pair += is_some ? 6 : 1)
    moved.push_back(pair);
  if (is_some) made.bad_pairs = moved;
  const std::vector<GridPair> sound = made.pairs;
  for (double factor = 1; made.moved_px <= least_px; factor *= 1.2) {
    double squares = 0;
    for (const std::size_t pair : moved) {
      const Isometry3d& pose = made.poses[pair];
      made.pairs[pair] = first_of(1000, [&] {
        const Vector3d place = pose.translation() + gaussian(random, factor * mm);
        const Matrix3d rotation = turned(gaussian(random, factor * degrees)) * pose.linear();
        return elsewhere(pair, Eigen::Translation3d(place) * Isometry3d(rotation));
      });
      for (std::size_t i = 0; i < sound[pair].right.size(); ++i)
        squares += (made.pairs[pair].right[i] - sound[pair].right[i]).squaredNorm();
    }
    made.moved_px = std::sqrt(squares / (1.0 * made.grid.corners() * static_cast<double>(moved.size())));
  }
}

// What goes wrong with the files: some are lost on each side, at different positions.
void spoil_order(SplitMix& random, FaultyRig& made, Fault fault) {
  std::vector<std::size_t> lefts(made.pairs.size());
  std::iota(lefts.begin(), lefts.end(), 0U);
  std::vector<std::size_t> rights = lefts;
  const int last = static_cast<int>(lefts.size()) - 1;
  const int late = whole(random, 1, 3);
  const int apart = whole(random, 1, last / 3);
  const int first = whole(random, 0, last - apart);
  const int way = sign(random);
  if (fault == Fault::kLate) {
    made.shift = way * late;
    lefts.resize(lefts.size() - static_cast<std::size_t>(late));
    rights.erase(rights.begin(), rights.begin() + late);
  }
  if (fault == Fault::kOneLostInEach) {
    lefts.erase(lefts.begin() + first + apart);
    rights.erase(rights.begin() + first);
    for (int i = first; i < first + apart; ++i) made.bad_pairs.push_back(static_cast<std::size_t>(i));
  }
  if (way < 0) std::swap(lefts, rights);
  if (fault == Fault::kReversed) std::reverse(rights.begin(), rights.end());
  const std::vector<GridPair> sound = std::exchange(made.pairs, {});
  for (std::size_t i = 0; i < lefts.size(); ++i)
    made.pairs.push_back({sound[lefts[i]].left, sound[rights[i]].right});
}

// What goes wrong with the pictures. The detector's rows and columns follow each other clockwise in every
// picture, also in a mirrored one.
void spoil_pictures(FaultyRig& made, Fault fault) {
  const double x = made.rig.width - 1;
  const double y = made.rig.height - 1;
  Eigen::Matrix<double, 2, 3> left = Eigen::Matrix<double, 2, 3>::Identity();
  Eigen::Matrix<double, 2, 3> right = left;
  if (fault == Fault::kUpsideDown) right << -1, 0, x, 0, -1, y;
  if (fault == Fault::kMirrored) right << -1, 0, x, 0, 1, 0;
  if (fault == Fault::kOppositeQuarters) {
    left << 0, 1, 0, -1, 0, x;
    right << 0, -1, y, 1, 0, 0;
    std::swap(made.width, made.height);
  }
  for (GridPair& pair : made.pairs) {
    for (Vector2d& corner : pair.left) corner = left * corner.homogeneous();
    for (Vector2d& corner : pair.right) corner = right * corner.homogeneous();
    if (fault == Fault::kMirrored) {
      for (auto row = pair.right.begin(); row != pair.right.end(); row += made.grid.columns)
        std::reverse(row, row + made.grid.columns);
    }
    if (fault == Fault::kExchanged) std::swap(pair.left, pair.right);
    pair.right = ordered_like(pair.left, made.grid, pair.right);
  }
}

FaultyRig photographed(SplitMix& random, FaultyRig made, Fault fault, double noise_px) {
  made.width = made.rig.width;
  made.height = made.rig.height;
  spoil_order(random, made, fault);
  for (GridPair& pair : made.pairs) {
    for (Corners* corners : {&pair.left, &pair.right}) {
      for (Vector2d& corner : *corners) corner += gaussian(random, noise_px).head<2>();
    }
  }
  spoil_pictures(made, fault);
  return made;
}

// Where the grid of the known rig stands, and how it is turned: centres and largest deviations.
struct Stand {
  std::size_t positions;
  Vector3d turn;    // degrees
  Vector3d centre;  // mm, of kTurnedFar from the right camera
  Vector3d spread;
};

Stand stand_of(Fault fault) {
  if (fault == Fault::kTurnedFar) return {8, {25, 25, 10}, {0, 0, 825}, {60, 50, 75}};
  if (fault == Fault::kVertical) return {12, {28, 28, 12}, {0, 30, 565}, {130, 90, 185}};
  if (fault == Fault::kHardlyTilted) return {8, {5, 5, 12}, {40, 0, 580}, {130, 90, 20}};
  if (fault == Fault::kFrontal) return {12, {0, 0, 3}, {0, 0, 565}, {60, 40, 0}};
  return {12, {28, 28, 12}, {40, 0, 565}, {130, 90, 185}};
}

}  // namespace

FaultyRig faulty_rig(std::uint64_t seed, double noise_px, Fault fault) {
  SplitMix random(mixed(seed));
  const double angle = random.between(35, 130);
  const Arrangement its = arrangement_of(fault, sign(random));
  FaultyRig made = first_of(2000, [&] { return try_rig(random, angle, its); });
  const bool is_little = fault == Fault::kMovedLittle;
  const double least_px = is_little ? 0 : random.between(1, 4) * std::max(0.5, 5 * noise_px);
  const double factor = is_little ? 0.5 : 0.05;
  const double mm = factor / 550 * made.poses.front().translation().z();
  spoil_scene(random, made, fault, mm, 0.2 * factor, least_px);
  return photographed(random, std::move(made), fault, noise_px);
}

RandomRig random_rig(std::uint64_t seed, double noise_px) { return faulty_rig(seed, noise_px, Fault::kNone); }

FaultyRig made_rig(std::uint64_t seed, Fault fault) {
  SplitMix random(mixed(seed));
  const bool is_far = fault == Fault::kTurnedFar;
  FaultyRig made;
  made.grid = {9, 6, 25};
  Rig& rig = made.rig;
  rig.width = 640;
  rig.height = 480;
  rig.left.matrix << 520, 0, 320, 0, 520, 240, 0, 0, 1;
  if (!is_far) rig.left.distortion = {-0.2, 0.05};
  rig.right = rig.left;
  const Arrangement its = arrangement_of(fault, 1);
  rig.rotation = its.rotation;
  rig.translation = (is_far ? -411.2 : -80) * (its.rotation * its.place);
  const Views views(rig);
  const Stand stand = stand_of(fault);
  while (made.pairs.size() < stand.positions) {
    made.pairs.push_back(first_of(1000, [&] {
      Vector3d middle = uniform(random, stand.spread);
      if (!is_far) middle.head<2>() *= (stand.centre.z() + middle.z()) / 550;
      middle += stand.centre;
      if (is_far)
        middle = (rig.rotation.transpose() * (middle - rig.translation)).cwiseProduct(Vector3d(0.8, 1, 1));
      const Isometry3d pose = pose_of(made.grid, turned(uniform(random, stand.turn)), middle);
      const auto seen = views.grid(made.grid, pose, pose);
      if (seen) made.poses.push_back(pose);
      return seen;
    }));
  }
  const double factor = fault == Fault::kMovedLittle ? 0.5 : 1;
  spoil_scene(random, made, fault, 4 * factor, 0.8 * factor, 0);
  return photographed(random, std::move(made), fault, 0.05);
}

}  // namespace stereotlm::test
