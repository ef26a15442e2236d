#include "sw/media/synthetic_rig.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "calib/split_mix.h"

namespace stereotlm::media {

using calib::CameraModel;
using calib::GridPair;
using calib::GridShape;
using calib::kSplitMixStep;
using calib::mixed;
using calib::Rectification;
using calib::Rig;
using calib::SplitMix;
using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using kernels::GrayImage;

namespace made_rig {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

// The points origin + t * direction, t > 0. Lengths of the scene are in mm.
struct Ray {
  Vector3d origin;
  Vector3d direction;

  Vector3d at(double t) const { return origin + t * direction; }
};

// A surface in front of the cameras.
struct Surface {
  std::function<double(const Ray&)> meets;       // t of the first point of the ray; infinite if there is none
  std::function<double(const Vector3d&)> level;  // the grey level of a point on it, 0..255
};

// The surfaces of a scene.
struct Scene {
  std::vector<Surface> surfaces;
  double background;  // the grey level of a ray that meets no surface

  // The surface that a ray meets first, and t of that point; null and infinite if it meets none.
  std::pair<const Surface*, double> first(const Ray& ray) const {
    std::pair<const Surface*, double> result = {nullptr, kNowhere};
    for (const Surface& surface : surfaces) {
      const double t = surface.meets(ray);
      if (t < result.second) result = {&surface, t};
    }
    return result;
  }
  // The grey level that is seen along a ray.
  double level(const Ray& ray) const {
    const auto [surface, t] = first(ray);
    return surface == nullptr ? background : surface->level(ray.at(t));
  }
};

// The floor of a value; std::floor would be a function call.
std::int64_t below(double value) {
  const auto towards_zero = static_cast<std::int64_t>(value);
  return towards_zero - (value < static_cast<double>(towards_zero) ? 1 : 0);
}

// A random value of 0..1 at a point of a lattice.
double lattice(std::uint64_t seed, std::int64_t column, std::int64_t row) {
  const std::uint64_t position = static_cast<std::uint64_t>(row) << 32U ^ static_cast<std::uint64_t>(column);
  return calib::unit(mixed(seed + position * kSplitMixStep));
}

double smooth(double part) { return part * part * (3 - 2 * part); }

// A value of 0..1, interpolated between the points of a lattice.
double value_noise(std::uint64_t seed, double x, double y) {
  const std::int64_t column = below(x);
  const std::int64_t row = below(y);
  const double right = smooth(x - static_cast<double>(column));
  const double down = smooth(y - static_cast<double>(row));
  const double above = lattice(seed, column, row) * (1 - right) + lattice(seed, column + 1, row) * right;
  const double under =
      lattice(seed, column, row + 1) * (1 - right) + lattice(seed, column + 1, row + 1) * right;
  return above * (1 - down) + under * down;
}

// Levels before they are rounded, row by row.
using Levels = std::vector<float>;

// Mixes each of `count` levels, which are `step` apart, with its two neighbours. Beyond the ends, the first
// and the last level repeat.
void mix(const float* in, float* out, std::size_t count, std::size_t step) {
  constexpr float kNeighbour = 0.15F;
  for (std::size_t i = 0; i < count; ++i) {
    const float before = in[(i > 0 ? i - 1 : 0) * step];
    const float after = in[std::min(i + 1, count - 1) * step];
    out[i * step] = (1 - 2 * kNeighbour) * in[i * step] + kNeighbour * (before + after);
  }
}

GrayImage through_lens(const Levels& levels, int width, int height) {
  const auto columns = static_cast<std::size_t>(width);
  const auto rows = static_cast<std::size_t>(height);
  Levels in_rows(levels.size());
  Levels result(levels.size());
  for (std::size_t y = 0; y < rows; ++y) mix(&levels[y * columns], &in_rows[y * columns], columns, 1);
  for (std::size_t x = 0; x < columns; ++x) mix(&in_rows[x], &result[x], rows, columns);
  GrayImage image(width, height);
  std::transform(result.begin(), result.end(), image.pixels.begin(),
                 [](float level) { return static_cast<std::uint8_t>(std::lround(level)); });
  return image;
}

// A grey level, 0..255, for every position on a surface. The surface defines the unit of length.
using Texture = std::function<double(const Vector2d& position)>;

// Smooth noise around a level, with details of one, two, four and eight units. It is flat nowhere.
Texture noise(std::uint64_t seed, double level) {
  return [seed, level](const Vector2d& position) {
    constexpr int kSizes = 4;
    constexpr double kContrast = 100;  // a standard deviation of about 40
    double sum = 0;
    double scale = 1;
    for (int size = 0; size < kSizes; ++size, scale /= 2) {
      const std::uint64_t own_seed = seed + static_cast<std::uint64_t>(size);
      sum += value_noise(own_seed, position.x() * scale, position.y() * scale) - 0.5;
    }
    return std::clamp(level + kContrast * sum, 0.0, 255.0);
  };
}

constexpr double kBlack = 30;  // grey levels of a grid
constexpr double kWhite = 220;

// A chessboard on white. The unit is a square and the first inner corner is the origin; the square above and
// to the left of it is black.
Texture chessboard(const GridShape& shape) {
  return [columns = shape.columns, rows = shape.rows](const Vector2d& position) {
    const std::int64_t column = below(position.x());
    const std::int64_t row = below(position.y());
    const bool on_squares = column >= -1 && column < columns && row >= -1 && row < rows;
    return on_squares && (column + row) % 2 == 0 ? kBlack : kWhite;
  };
}

// Black circles on white. The unit is GridShape::square_mm and the centre of the first circle is the origin.
Texture circles(const GridShape& shape) {
  const GridShape in_units = {shape.columns, shape.rows, 1, shape.pattern};
  const double radius = shape.pattern == calib::Pattern::kCircles ? 0.3 : 0.5;
  return [radius, centres = calib::corner_points(in_units)](const Vector2d& position) {
    const auto is_inside = [&](const Vector3d& centre) {
      return (centre.head<2>() - position).norm() < radius;
    };
    return std::any_of(centres.begin(), centres.end(), is_inside) ? kBlack : kWhite;
  };
}

// A textured rectangle, the same on both sides. `origin` is the origin of its texture. `across` and `down`,
// at right angles, are one unit of the texture each. `extent` is the rectangle in these units.
Surface plane(const Vector3d& origin, const Vector3d& across, const Vector3d& down,
              const Eigen::AlignedBox2d& extent, Texture texture) {
  const Vector3d normal = across.cross(down).normalized();
  const auto position = [origin, to_across = Vector3d(across / across.squaredNorm()),
                         to_down = Vector3d(down / down.squaredNorm())](const Vector3d& point) -> Vector2d {
    const Vector3d from_origin = point - origin;
    return {to_across.dot(from_origin), to_down.dot(from_origin)};
  };
  return {
      [=](const Ray& ray) {
        const double t = normal.dot(origin - ray.origin) / normal.dot(ray.direction);
        // A ray that is parallel to the plane or lies in it misses it too.
        if (!(t > 0) || !std::isfinite(t) || !extent.contains(position(ray.at(t)))) return kNowhere;
        return t;
      },
      [position, texture = std::move(texture)](const Vector3d& point) { return texture(position(point)); }};
}

// A sphere whose texture is projected from far away along the z axis, so that it looks as fine at the rim as
// in the middle. A unit of the texture is `unit_mm`.
Surface sphere(const Vector3d& centre, double radius, double unit_mm, Texture texture) {
  return {[=](const Ray& ray) {
            const Vector3d to_centre = centre - ray.origin;
            const double square = ray.direction.squaredNorm();
            const double middle = ray.direction.dot(to_centre) / square;
            const double half_squared =
                middle * middle - (to_centre.squaredNorm() - radius * radius) / square;
            if (!(half_squared >= 0)) return kNowhere;
            const double t = middle - std::sqrt(half_squared);
            if (!(t > 0)) return kNowhere;
            return t;
          },
          [=, texture = std::move(texture)](const Vector3d& point) {
            return texture((point - centre).head<2>() / unit_mm);
          }};
}

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

// Several random numbers of one expression stand in braces, whose elements are evaluated in order. Arguments
// in parentheses are not.
Scene random_scene(std::uint64_t seed, const Rig& rig) {
  SplitMix random = random_for(seed, Part::scene);
  std::vector<Surface> surfaces;
  const auto add_plane = [&](const Rectangle& shape) {
    const Matrix3d axes = (AngleAxisd(radians(shape.turn), Vector3d::UnitY()) *
                           AngleAxisd(radians(shape.tilt), Vector3d::UnitX()))
                              .toRotationMatrix();
    const double unit = unit_at(shape.middle.z(), rig);
    const Vector2d units(unit, unit * shape.foreshortened);
    const Vector2d corner = shape.size.cwiseQuotient(2 * units);
    surfaces.push_back(plane(shape.middle, axes.col(0) * units.x(), axes.col(1) * units.y(),
                             {-corner, corner}, noise(random.next(), shape.level)));
  };
  const auto add_sphere = [&](const Vector3d& centre, double radius, double level) {
    const Vector3d moved{centre.x() + random.between(-60, 60), centre.y() + random.between(-40, 40),
                         centre.z()};
    surfaces.push_back(sphere(moved, radius, unit_at(centre.z() - radius, rig), noise(random.next(), level)));
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

// The corners of squares of square_mm that cover the grid, with one square around its corners.
std::vector<Vector3d> square_corners(const GridShape& shape) {
  const Eigen::Vector2i last = shape.extent().cast<int>();
  std::vector<Vector3d> points = calib::corner_points({last.x() + 3, last.y() + 3, shape.square_mm});
  for (Vector3d& point : points) point -= Vector3d(shape.square_mm, shape.square_mm, 0);
  return points;
}

// Whether a position lies on a pixel of a width x height picture.
bool inside(const Vector2d& position, int width, int height) {
  return position.x() >= -0.5 && position.x() < width - 0.5 &&  //
         position.y() >= -0.5 && position.y() < height - 0.5;
}

// The pixel at which a camera sees a point in its own coordinates; nullopt if it is not in the picture.
std::optional<Vector2d> pixel_of(const CameraModel& camera, const Vector3d& point, int width, int height) {
  if (!(point.z() > 0)) return std::nullopt;
  const Vector2d pixel = camera.pixel(point.hnormalized());
  if (!inside(pixel, width, height)) return std::nullopt;
  return pixel;
}

// The pixels at which the cameras see points, which are in coordinates of the left camera; nullopt unless
// both see all points.
std::optional<GridPair> seen(const Rig& rig, const std::vector<Vector3d>& points) {
  GridPair result;
  for (const Vector3d& point : points) {
    const auto left = pixel_of(rig.left, point, rig.width, rig.height);
    if (!left) return std::nullopt;
    const Vector3d from_right = rig.rotation * point + rig.translation;
    const auto right = pixel_of(rig.right, from_right, rig.width, rig.height);
    if (!right) return std::nullopt;
    result.left.push_back(*left);
    result.right.push_back(*right);
  }
  return result;
}

// Maps chessboard coordinates to those of the left camera. The size and the direction of the tilt follow from
// the number, so that a few poses are well spread. Positions are drawn at random, each a little farther away,
// until the squares lie inside both pictures.
Eigen::Isometry3d grid_pose(std::uint64_t seed, const Rig& rig, const GridShape& shape, int number) {
  constexpr int kMostDraws = 500;
  constexpr double kFartherEachTime = 1.003;
  constexpr double kGoldenRatio = 1.618033988749895;
  constexpr double kRootOfTwo = 1.4142135623730951;
  SplitMix random(random_for(seed, Part::poses).next() + static_cast<std::uint64_t>(number));

  const Vector2d middle = shape.extent() * shape.square_mm / 2;
  const Vector2d squares = (shape.extent() + Vector2d(2, 2)) * shape.square_mm;
  const double focal = rig.left.matrix(0, 0);
  // The squares fill this part of a side of the picture.
  const double part = 0.4 + 0.3 * std::fmod(number * kGoldenRatio, 1.0);
  constexpr double kApart = 0.25;  // the largest disparity, as a part of the width
  double distance = focal * std::max({squares.x() / rig.width / part, squares.y() / rig.height / part,
                                      rig.translation.norm() / rig.width / kApart});

  const double tilt_towards = 2 * kPi * std::fmod(number * kRootOfTwo, 1.0);
  const Vector3d tilt_axis(std::cos(tilt_towards), std::sin(tilt_towards), 0);
  const AngleAxisd tilt(radians(random.between(10, 35)), tilt_axis);
  const AngleAxisd roll(radians(random.between(-20, 20)), Vector3d::UnitZ());

  for (int draw = 0; draw < kMostDraws; ++draw, distance *= kFartherEachTime) {
    const Vector2d place{random.between(0, rig.width - 1), random.between(0, rig.height - 1)};
    const Vector3d sight = rig.left.direction(place).homogeneous().normalized();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(distance * sight);
    pose.rotate(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), sight));
    pose.rotate(tilt * roll);
    pose.translate(Vector3d(-middle.x(), -middle.y(), 0));
    std::vector<Vector3d> points = square_corners(shape);
    for (Vector3d& point : points) point = pose * point;
    if (seen(rig, points)) return pose;
  }
  throw std::domain_error("grid = " + std::to_string(shape.columns) + " x " + std::to_string(shape.rows) +
                          ": must fit into what both pictures of " + std::to_string(rig.width) + " x " +
                          std::to_string(rig.height) + " pixels show");
}

// Renders the pictures of a camera from one place in the scene, slightly blurred. Stores the direction of the
// ray at every corner of a pixel: computing them takes longer than rendering most pictures.
class Camera {
 public:
  // `to_scene` turns directions in camera coordinates to scene coordinates. Throws as
  // CameraModel::direction() does.
  Camera(const CameraModel& model, const Vector3d& place, const Matrix3d& to_scene, int width, int height)
      : width_(width), height_(height), place_(place), to_scene_(to_scene) {
    directions_.reserve((static_cast<std::size_t>(width) + 1) * (static_cast<std::size_t>(height) + 1));
    for (int y = 0; y <= height; ++y) {
      for (int x = 0; x <= width; ++x) {
        directions_.emplace_back(model.direction({x - 0.5, y - 0.5}).cast<float>());
      }
    }
  }

  const Vector3d& place() const { return place_; }

  // Every pixel is a mean of samples: of 64 if an edge crosses it, else of five. The rays are exact at the
  // corners of the pixels and interpolated between them, with an error below 0.001 pixels at 320 x 240.
  GrayImage picture(const Scene& scene) const {
    Levels levels;
    levels.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    std::vector<Corner> above = corners_above(0, scene);
    for (int y = 0; y < height_; ++y) {
      std::vector<Corner> under = corners_above(y + 1, scene);
      for (std::size_t x = 0; x < static_cast<std::size_t>(width_); ++x) {
        levels.push_back(static_cast<float>(level(scene, above[x], above[x + 1], under[x], under[x + 1])));
      }
      above = std::move(under);
    }
    return through_lens(levels, width_, height_);
  }

 private:
  struct Corner {
    Vector3d direction;
    double level;
  };

  // The corners above a row of pixels.
  std::vector<Corner> corners_above(int row, const Scene& scene) const {
    std::vector<Corner> result;
    const std::size_t count = static_cast<std::size_t>(width_) + 1;
    result.reserve(count);
    for (std::size_t x = 0; x < count; ++x) {
      const Vector2d seen = directions_[static_cast<std::size_t>(row) * count + x].cast<double>();
      const Vector3d direction = to_scene_ * seen.homogeneous();
      result.push_back({direction, scene.level({place_, direction})});
    }
    return result;
  }

  // The grey level of the pixel whose upper corners are a and b, and whose lower corners are c and d: the
  // mean of samples at its middle and at its corners, which neighbouring pixels share. If the corners differ
  // by kEdge or more, an edge crosses the pixel, and the mean of 64 samples is taken instead.
  double level(const Scene& scene, const Corner& a, const Corner& b, const Corner& c, const Corner& d) const {
    constexpr double kEdge = 95;
    constexpr int kSamplesOfAnEdge = 8;  // in each direction
    const auto [least, most] = std::minmax({a.level, b.level, c.level, d.level});
    if (most - least < kEdge) {
      const Vector3d middle = (a.direction + b.direction + c.direction + d.direction) / 4;
      return (a.level + b.level + c.level + d.level) / 8 + scene.level({place_, middle}) / 2;
    }
    double sum = 0;
    for (int j = 0; j < kSamplesOfAnEdge; ++j) {
      const double down = (j + 0.5) / kSamplesOfAnEdge;
      const Vector3d first = a.direction + down * (c.direction - a.direction);
      const Vector3d last = b.direction + down * (d.direction - b.direction);
      for (int i = 0; i < kSamplesOfAnEdge; ++i) {
        const double across = (i + 0.5) / kSamplesOfAnEdge;
        sum += scene.level({place_, first + across * (last - first)});
      }
    }
    return sum / (kSamplesOfAnEdge * kSamplesOfAnEdge);
  }

  int width_;
  int height_;
  Vector3d place_;
  Matrix3d to_scene_;
  std::vector<Eigen::Vector2f> directions_;  // (width + 1) x (height + 1) corners of pixels, row by row
};

struct View {
  Scene scene;
  Camera left;  // scene coordinates are those of the left camera
  Camera right;
};

}  // namespace made_rig

using namespace made_rig;

SyntheticRig::SyntheticRig(std::uint64_t seed, int width, int height)
    : seed_(seed),
      rig_(random_rig(seed, width, height)),
      view_(std::make_shared<View>(View{random_scene(seed, rig_),
                                        {rig_.left, Vector3d::Zero(), Matrix3d::Identity(), width, height},
                                        {rig_.right, -(rig_.rotation.transpose() * rig_.translation),
                                         rig_.rotation.transpose(), width, height}})) {}

SyntheticRig::Pair SyntheticRig::grid_view(const GridShape& shape, int number) const {
  const Eigen::Isometry3d pose = grid_pose(seed_, rig_, shape, number);
  const Vector2d border(2, 2);
  const Eigen::AlignedBox2d extent(-border, shape.extent() + border);
  const Matrix3d axes = pose.linear() * shape.square_mm;
  Texture texture = shape.pattern == calib::Pattern::kChessboard ? chessboard(shape) : circles(shape);
  const Scene scene = {{plane(pose.translation(), axes.col(0), axes.col(1), extent, std::move(texture))},
                       kGridBackground};
  return {view_->left.picture(scene), view_->right.picture(scene)};
}

GridPair SyntheticRig::grid_corners(const GridShape& shape, int number) const {
  const Eigen::Isometry3d pose = grid_pose(seed_, rig_, shape, number);
  std::vector<Vector3d> points = calib::corner_points(shape);
  for (Vector3d& point : points) point = pose * point;
  return seen(rig_, points).value();
}

SyntheticRig::Pair SyntheticRig::scene() const {
  return {view_->left.picture(view_->scene), view_->right.picture(view_->scene)};
}

std::optional<Vector3d> SyntheticRig::point(const Vector2d& left_pixel) const {
  if (!inside(left_pixel, rig_.width, rig_.height)) return std::nullopt;
  const Ray ray = {Vector3d::Zero(), rig_.left.direction(left_pixel).homogeneous()};
  const auto [surface, t] = view_->scene.first(ray);
  if (surface == nullptr) return std::nullopt;
  return ray.at(t);
}

std::optional<Vector2d> SyntheticRig::match(const Vector2d& left_pixel) const {
  constexpr double kRounding = 1e-6;
  const std::optional<Vector3d> found = point(left_pixel);
  if (!found) return std::nullopt;
  const Vector3d& eye = view_->right.place();
  if (view_->scene.first({eye, *found - eye}).second < 1 - kRounding) return std::nullopt;  // hidden
  return pixel_of(rig_.right, rig_.rotation * *found + rig_.translation, rig_.width, rig_.height);
}

std::vector<float> SyntheticRig::disparity(const Rig& calibrated, const Rectification& rectification,
                                           int disparity_offset) const {
  const calib::SourcePixels sources(calibrated.left, rectification.r1, rectification.p1);
  std::vector<float> result;
  result.reserve(static_cast<std::size_t>(rig_.width) * static_cast<std::size_t>(rig_.height));
  for (int v = 0; v < rig_.height; ++v) {
    for (int u = 0; u < rig_.width; ++u) {
      const auto left = sources.at({static_cast<double>(u) + disparity_offset, v});
      const auto right = left ? match(*left) : std::nullopt;
      const double found =
          right ? u - calib::rectified_pixel(calibrated.right, rectification.r2, rectification.p2, *right).x()
                : std::numeric_limits<double>::quiet_NaN();
      result.push_back(static_cast<float>(found));
    }
  }
  return result;
}

GreyTruth truth_of(const std::vector<float>& disparity, int width, int disparities) {
  const int scale = 255 / disparities;
  GreyTruth truth = {GrayImage(width, static_cast<int>(disparity.size()) / width), scale};
  std::transform(disparity.begin(), disparity.end(), truth.grey.pixels.begin(), [scale](float each) {
    const double level = std::floor(double{each} * scale + 0.5);
    return static_cast<std::uint8_t>(level > 0 && level <= 255 ? level : 0);  // 0 for NaN too
  });
  return truth;
}

}  // namespace stereotlm::media
