#include "calib/scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "calib/split_mix.h"

namespace stereotlm::calib {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

// The floor of a value; std::floor would be a function call.
std::int64_t below(double value) {
  const auto towards_zero = static_cast<std::int64_t>(value);
  return towards_zero - (value < static_cast<double>(towards_zero) ? 1 : 0);
}

// A random value of 0..1 at a point of a lattice.
double lattice(std::uint64_t seed, std::int64_t column, std::int64_t row) {
  const std::uint64_t position = static_cast<std::uint64_t>(row) << 32U ^ static_cast<std::uint64_t>(column);
  return unit(mixed(seed + position * kSplitMixStep));
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

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using kernels::GrayImage;

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

}  // namespace

Texture noise(std::uint64_t seed, double level) {
  return [seed, level](const Eigen::Vector2d& position) {
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

Texture chessboard(const GridShape& shape) {
  return [columns = shape.columns, rows = shape.rows](const Eigen::Vector2d& position) {
    constexpr double kBlack = 30;
    constexpr double kWhite = 220;
    const std::int64_t column = below(position.x());
    const std::int64_t row = below(position.y());
    const bool on_squares = column >= -1 && column < columns && row >= -1 && row < rows;
    return on_squares && (column + row) % 2 == 0 ? kBlack : kWhite;
  };
}

Plane::Plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& across, const Eigen::Vector3d& down,
             const Eigen::AlignedBox2d& extent, Texture texture)
    : origin_(origin),
      normal_(across.cross(down).normalized()),
      to_across_(across / across.squaredNorm()),
      to_down_(down / down.squaredNorm()),
      extent_(extent),
      texture_(std::move(texture)) {}

double Plane::meets(const Ray& ray) const {
  const double t = normal_.dot(origin_ - ray.origin) / normal_.dot(ray.direction);
  // A ray that is parallel to the plane or lies in it misses it too.
  if (!(t > 0) || !std::isfinite(t)) return kNowhere;
  if (!extent_.contains(position(ray.at(t)))) return kNowhere;
  return t;
}

Eigen::Vector2d Plane::position(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d from_origin = point - origin_;
  return {to_across_.dot(from_origin), to_down_.dot(from_origin)};
}

Sphere::Sphere(const Eigen::Vector3d& centre, double radius, double unit_mm, Texture texture)
    : centre_(centre), radius_(radius), unit_mm_(unit_mm), texture_(std::move(texture)) {}

double Sphere::meets(const Ray& ray) const {
  const Eigen::Vector3d to_centre = centre_ - ray.origin;
  const double square = ray.direction.squaredNorm();
  const double middle = ray.direction.dot(to_centre) / square;
  const double half_squared = middle * middle - (to_centre.squaredNorm() - radius_ * radius_) / square;
  if (!(half_squared >= 0)) return kNowhere;
  const double t = middle - std::sqrt(half_squared);
  if (!(t > 0)) return kNowhere;
  return t;
}

double Sphere::level(const Eigen::Vector3d& point) const {
  return texture_((point - centre_).head<2>() / unit_mm_);
}

SceneSurfaces::SceneSurfaces(std::vector<std::variant<Plane, Sphere>> surfaces, double background)
    : surfaces_(std::move(surfaces)), background_(background) {}

SceneSurfaces::Nearest SceneSurfaces::nearest(const Ray& ray) const {
  Nearest result = {nullptr, kNowhere};
  for (const Surface& surface : surfaces_) {
    const double t = std::visit([&ray](const auto& shape) { return shape.meets(ray); }, surface);
    if (t < result.t) result = {&surface, t};
  }
  return result;
}

std::optional<Eigen::Vector3d> SceneSurfaces::first(const Ray& ray) const {
  const Nearest found = nearest(ray);
  if (found.surface == nullptr) return std::nullopt;
  return ray.at(found.t);
}

bool SceneSurfaces::visible(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) const {
  constexpr double kRounding = 1e-6;
  return nearest({eye, point - eye}).t >= 1 - kRounding;
}

double SceneSurfaces::level(const Ray& ray) const {
  const Nearest found = nearest(ray);
  if (found.surface == nullptr) return background_;
  return std::visit([point = ray.at(found.t)](const auto& shape) { return shape.level(point); },
                    *found.surface);
}

struct SceneCamera::Corner {
  Vector3d direction;
  double level;
};

SceneCamera::SceneCamera(const CameraModel& model, const Vector3d& place, const Matrix3d& to_scene, int width,
                         int height)
    : width_(width), height_(height), place_(place), to_scene_(to_scene) {
  directions_.reserve((static_cast<std::size_t>(width) + 1) * (static_cast<std::size_t>(height) + 1));
  for (int y = 0; y <= height; ++y) {
    for (int x = 0; x <= width; ++x) {
      directions_.emplace_back(model.direction({x - 0.5, y - 0.5}).cast<float>());
    }
  }
}

std::vector<SceneCamera::Corner> SceneCamera::corners_above(int row, const SceneSurfaces& surfaces) const {
  std::vector<Corner> result;
  const std::size_t count = static_cast<std::size_t>(width_) + 1;
  result.reserve(count);
  for (std::size_t x = 0; x < count; ++x) {
    const Vector2d seen = directions_[static_cast<std::size_t>(row) * count + x].cast<double>();
    const Vector3d direction = to_scene_ * seen.homogeneous();
    result.push_back({direction, surfaces.level({place_, direction})});
  }
  return result;
}

// Samples the middle of the pixel and its corners, which neighbouring pixels share. If their levels show that
// an edge crosses the pixel, takes 64 samples instead.
double SceneCamera::level(const SceneSurfaces& surfaces, const Corner& a, const Corner& b, const Corner& c,
                          const Corner& d) const {
  constexpr double kEdge = 95;
  constexpr int kSamplesOfAnEdge = 8;  // in each direction
  const auto [least, most] = std::minmax({a.level, b.level, c.level, d.level});
  if (most - least < kEdge) {
    const Vector3d middle = (a.direction + b.direction + c.direction + d.direction) / 4;
    return (a.level + b.level + c.level + d.level) / 8 + surfaces.level({place_, middle}) / 2;
  }
  double sum = 0;
  for (int j = 0; j < kSamplesOfAnEdge; ++j) {
    const double down = (j + 0.5) / kSamplesOfAnEdge;
    const Vector3d first = a.direction + down * (c.direction - a.direction);
    const Vector3d last = b.direction + down * (d.direction - b.direction);
    for (int i = 0; i < kSamplesOfAnEdge; ++i) {
      const double across = (i + 0.5) / kSamplesOfAnEdge;
      sum += surfaces.level({place_, first + across * (last - first)});
    }
  }
  return sum / (kSamplesOfAnEdge * kSamplesOfAnEdge);
}

GrayImage SceneCamera::picture(const SceneSurfaces& surfaces) const {
  Levels levels;
  levels.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  std::vector<Corner> above = corners_above(0, surfaces);
  for (int y = 0; y < height_; ++y) {
    std::vector<Corner> under = corners_above(y + 1, surfaces);
    for (std::size_t x = 0; x < static_cast<std::size_t>(width_); ++x) {
      levels.push_back(static_cast<float>(level(surfaces, above[x], above[x + 1], under[x], under[x + 1])));
    }
    above = std::move(under);
  }
  return through_lens(levels, width_, height_);
}

}  // namespace stereotlm::calib
