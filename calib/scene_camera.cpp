#include "calib/scene_camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace stereotlm::calib {
namespace {

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
