#include "calib/synthetic_rig.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "calib/split_mix.h"

namespace stereotlm::calib {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kGridBackground = 115;
constexpr double kPi = 3.14159265358979323846;

// Each part of the rig has its own sequence of random numbers, so that no part depends on how many numbers
// another draws.
enum class Part : std::uint64_t { rig, scene, poses };

SplitMix random_for(std::uint64_t seed, Part part) {
  return SplitMix(mixed(mixed(seed) + static_cast<std::uint64_t>(part)));
}

double radians(double degrees) { return degrees * (kPi / 180); }

// The width of the smallest 4:3 picture that contains this one.
double full_width(int width, int height) { return std::max<double>(width, height * 4.0 / 3.0); }

CameraModel random_camera(SplitMix& random, int width, int height) {
  CameraModel camera;
  const double focal = random.about(0.83 * full_width(width, height), 0.02);
  camera.matrix << focal, 0, (width - 1) / 2.0 + random.between(-0.03, 0.03) * width,            //
      0, random.about(focal, 0.004), (height - 1) / 2.0 + random.between(-0.03, 0.03) * height,  //
      0, 0, 1;
  // Within these bounds the lens never folds a picture over.
  camera.distortion = {random.about(-0.28, 0.04), random.about(0.07, 0.04), random.between(-0.0015, 0.0015),
                       random.between(-0.0015, 0.0015), random.between(0, 0.01)};
  return camera;
}

Rig random_rig(std::uint64_t seed, int width, int height) {
  SplitMix random = random_for(seed, Part::rig);
  Rig rig;
  rig.width = width;
  rig.height = height;
  rig.left = random_camera(random, width, height);
  rig.right = random_camera(random, width, height);
  Vector3d angles;
  for (double& angle : angles) angle = radians(random.between(-1.5, 1.5));
  rig.rotation = (AngleAxisd(angles.x(), Vector3d::UnitX()) * AngleAxisd(angles.y(), Vector3d::UnitY()) *
                  AngleAxisd(angles.z(), Vector3d::UnitZ()))
                     .toRotationMatrix();
  rig.translation = {random.about(-80, 0.03), random.between(-1.5, 1.5), random.between(-1.5, 1.5)};
  return rig;
}

// The finest texture in mm that the cameras resolve at a distance.
double unit_at(double distance, const Rig& rig) {
  constexpr double kPixels = 2;
  return kPixels * distance / rig.left.matrix(0, 0);
}

// A rectangle that stands upright, is tilted, then turned.
struct Rectangle {
  Vector3d middle;
  double turn;           // degrees
  double tilt;           // degrees
  Vector2d size;         // mm
  double foreshortened;  // the factor by which it looks lower than it is
  double level;
};

// Draws random numbers only inside braces, whose elements are evaluated in order. Arguments in parentheses
// are not.
SceneSurfaces random_scene(std::uint64_t seed, const Rig& rig) {
  SplitMix random = random_for(seed, Part::scene);
  std::vector<std::variant<Plane, Sphere>> surfaces;
  const auto add_plane = [&](const Rectangle& shape) {
    const Matrix3d axes = (AngleAxisd(radians(shape.turn), Vector3d::UnitY()) *
                           AngleAxisd(radians(shape.tilt), Vector3d::UnitX()))
                              .toRotationMatrix();
    const double unit = unit_at(shape.middle.z(), rig);
    const Vector2d units(unit, unit * shape.foreshortened);
    const Vector2d corner = shape.size.cwiseQuotient(2 * units);
    surfaces.emplace_back(Plane(shape.middle, axes.col(0) * units.x(), axes.col(1) * units.y(),
                                {-corner, corner}, noise(random.next(), shape.level)));
  };
  const auto add_sphere = [&](const Vector3d& centre, double radius, double level) {
    const Vector3d moved{centre.x() + random.between(-60, 60), centre.y() + random.between(-40, 40),
                         centre.z()};
    surfaces.emplace_back(
        Sphere(moved, radius, unit_at(centre.z() - radius, rig), noise(random.next(), level)));
  };
  // A wall, a floor and a panel in front of the wall.
  add_plane({{0, 0, 2050}, random.between(-3, 3), 0, {8000, 8000}, 1, 110});
  add_plane({{0, random.about(350, 0.04), 1300}, 0, random.between(88, 92), {8000, 8000}, 3, 145});
  add_plane({{random.between(-250, -150), random.between(-260, -200), 1450},
             random.between(30, 40),
             random.between(-10, 10),
             {520, 420},
             1,
             160});
  add_sphere({-330, 110, 1150}, random.about(170, 0.05), 90);
  add_sphere({270, -120, 730}, random.about(115, 0.05), 150);
  add_sphere({430, 140, 1500}, random.about(190, 0.05), 125);
  return {std::move(surfaces), 0};
}

// The inner corners and the corners at the border of the black and white squares.
std::vector<Vector3d> square_corners(const GridShape& shape) {
  std::vector<Vector3d> points = corner_points({shape.columns + 2, shape.rows + 2, shape.square_mm});
  for (Vector3d& point : points) point -= Vector3d(shape.square_mm, shape.square_mm, 0);
  return points;
}

// Whether a position lies on a pixel of a width x height picture.
bool inside(const Vector2d& position, int width, int height) {
  return position.x() >= -0.5 && position.x() < width - 0.5 &&  //
         position.y() >= -0.5 && position.y() < height - 0.5;
}

// The pixel at which a camera sees a point, which is in its own coordinates; nullopt if it is not in the
// picture.
std::optional<Vector2d> pixel_of(const CameraModel& camera, const Vector3d& point, int width, int height) {
  if (!(point.z() > 0)) return std::nullopt;
  const Vector2d pixel = camera.pixel(point.hnormalized());
  if (!inside(pixel, width, height)) return std::nullopt;
  return pixel;
}

}  // namespace

SyntheticRig::SyntheticRig(std::uint64_t seed, int width, int height)
    : seed_(seed),
      rig_(random_rig(seed, width, height)),
      left_(rig_.left, Vector3d::Zero(), Matrix3d::Identity(), width, height),
      right_(rig_.right, -(rig_.rotation.transpose() * rig_.translation), rig_.rotation.transpose(), width,
             height),
      scene_(random_scene(seed, rig_)) {}

SyntheticRig::Pair SyntheticRig::grid_view(const GridShape& shape, int number) const {
  const Eigen::Isometry3d pose = grid_pose(shape, number);
  const Vector2d border(2, 2);
  const Eigen::AlignedBox2d extent(-border, Vector2d(shape.columns - 1, shape.rows - 1) + border);
  const Matrix3d axes = pose.linear() * shape.square_mm;
  const Plane board(pose.translation(), axes.col(0), axes.col(1), extent, chessboard(shape));
  const SceneSurfaces surfaces({board}, kGridBackground);
  return {left_.picture(surfaces), right_.picture(surfaces)};
}

GridPair SyntheticRig::grid_corners(const GridShape& shape, int number) const {
  const Eigen::Isometry3d pose = grid_pose(shape, number);
  std::vector<Vector3d> points = corner_points(shape);
  for (Vector3d& point : points) point = pose * point;
  return seen(points).value();
}

// Size and tilt follow from the number, so that a few poses are well spread. Positions are drawn at random,
// each a little farther away, until the squares lie inside both pictures.
Eigen::Isometry3d SyntheticRig::grid_pose(const GridShape& shape, int number) const {
  constexpr int kMostDraws = 500;
  constexpr double kFartherEachTime = 1.003;
  constexpr double kGoldenRatio = 1.618033988749895;
  constexpr double kRootOfTwo = 1.4142135623730951;
  SplitMix random(random_for(seed_, Part::poses).next() + static_cast<std::uint64_t>(number));

  const Vector2d middle = Vector2d(shape.columns - 1, shape.rows - 1) * shape.square_mm / 2;
  const Vector2d squares = Vector2d(shape.columns + 1, shape.rows + 1) * shape.square_mm;
  const double focal = rig_.left.matrix(0, 0);
  // The squares fill this part of a side of the picture.
  const double part = 0.4 + 0.3 * std::fmod(number * kGoldenRatio, 1.0);
  constexpr double kApart = 0.25;  // the largest disparity, as a part of the width
  double distance = focal * std::max({squares.x() / rig_.width / part, squares.y() / rig_.height / part,
                                      rig_.translation.norm() / rig_.width / kApart});

  const double tilt_towards = 2 * kPi * std::fmod(number * kRootOfTwo, 1.0);
  const Vector3d tilt_axis(std::cos(tilt_towards), std::sin(tilt_towards), 0);
  const AngleAxisd tilt(radians(random.between(10, 35)), tilt_axis);
  const AngleAxisd roll(radians(random.between(-20, 20)), Vector3d::UnitZ());

  for (int draw = 0; draw < kMostDraws; ++draw, distance *= kFartherEachTime) {
    const Vector2d place{random.between(0, rig_.width - 1), random.between(0, rig_.height - 1)};
    const Vector3d sight = rig_.left.direction(place).homogeneous().normalized();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(distance * sight);
    pose.rotate(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), sight));
    pose.rotate(tilt * roll);
    pose.translate(Vector3d(-middle.x(), -middle.y(), 0));
    std::vector<Vector3d> points = square_corners(shape);
    for (Vector3d& point : points) point = pose * point;
    if (seen(points)) return pose;
  }
  throw std::domain_error("grid = " + std::to_string(shape.columns) + " x " + std::to_string(shape.rows) +
                          ": must fit into what both pictures of " + std::to_string(rig_.width) + " x " +
                          std::to_string(rig_.height) + " pixels show");
}

// The pixels at which the cameras see points, which are in coordinates of the left camera; nullopt unless
// both see all points.
std::optional<GridPair> SyntheticRig::seen(const std::vector<Vector3d>& points) const {
  GridPair result;
  for (const Vector3d& point : points) {
    const auto left = pixel_of(rig_.left, point, rig_.width, rig_.height);
    if (!left) return std::nullopt;
    const Vector3d from_right = rig_.rotation * point + rig_.translation;
    const auto right = pixel_of(rig_.right, from_right, rig_.width, rig_.height);
    if (!right) return std::nullopt;
    result.left.push_back(*left);
    result.right.push_back(*right);
  }
  return result;
}

SyntheticRig::Pair SyntheticRig::scene() const { return {left_.picture(scene_), right_.picture(scene_)}; }

std::optional<Vector3d> SyntheticRig::point(const Vector2d& left_pixel) const {
  if (!inside(left_pixel, rig_.width, rig_.height)) return std::nullopt;
  return scene_.first({Vector3d::Zero(), rig_.left.direction(left_pixel).homogeneous()});
}

std::optional<Vector2d> SyntheticRig::match(const Vector2d& left_pixel) const {
  const std::optional<Vector3d> found = point(left_pixel);
  if (!found || !scene_.visible(right_.place(), *found)) return std::nullopt;
  return pixel_of(rig_.right, rig_.rotation * *found + rig_.translation, rig_.width, rig_.height);
}

std::vector<float> SyntheticRig::disparity(const Rig& calibrated, const Rectification& rectification,
                                           int disparity_offset) const {
  const SourcePixels sources(calibrated.left, rectification.r1, rectification.p1);
  std::vector<float> result;
  result.reserve(static_cast<std::size_t>(rig_.width) * static_cast<std::size_t>(rig_.height));
  for (int v = 0; v < rig_.height; ++v) {
    for (int u = 0; u < rig_.width; ++u) {
      const auto left = sources.at({static_cast<double>(u) + disparity_offset, v});
      const auto right = left ? match(*left) : std::nullopt;
      const double found =
          right ? u - rectified_pixel(calibrated.right, rectification.r2, rectification.p2, *right).x()
                : std::numeric_limits<double>::quiet_NaN();
      result.push_back(static_cast<float>(found));
    }
  }
  return result;
}

}  // namespace stereotlm::calib
