#include "calib/depth.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "models/kernels/lr_check.h"

namespace stereotlm::calib {
namespace {

template <typename Visit>
void for_each_point(const DepthGeometry& geometry, const kernels::GrayImage& disparity, const Visit& visit) {
  for (int row = 0; row < disparity.height; ++row) {
    for (int column = 0; column < disparity.width; ++column) {
      const int d = disparity.at(column, row);
      if (d == kernels::kInvalidDisparity) continue;
      if (const auto point = geometry.point(column, row, d)) visit(column, row, *point);
    }
  }
}

// Little endian, as in memory.
void append(std::string& bytes, double value) {
  const auto single = static_cast<float>(value);
  bytes.append(reinterpret_cast<const char*>(&single), sizeof single);
}

}  // namespace

std::optional<Eigen::Vector3d> DepthGeometry::point(double column, double row, double disparity) const {
  const Eigen::Vector4d seen(column + disparity_offset, row, disparity + disparity_offset, 1);
  const Eigen::Vector4d homogeneous = q * seen;
  const Eigen::Vector3d result = homogeneous.hnormalized();
  if (!result.allFinite() || result.z() <= 0) return std::nullopt;
  return result;
}

std::optional<double> depth_in_the_middle(const Calibration& calibration, int disparity) {
  const DepthGeometry geometry = {calibration.rectification.q, calibration.disparity_offset};
  const auto point = geometry.point(calibration.rig.width / 2.0, calibration.rig.height / 2.0, disparity);
  return point ? std::optional(point->z()) : std::nullopt;
}

double disparity_at(const DepthGeometry& geometry, double depth_mm) {
  const double of_rectified = (geometry.q(2, 3) / depth_mm - geometry.q(3, 3)) / geometry.q(3, 2);
  return of_rectified - geometry.disparity_offset;
}

std::vector<std::uint16_t> depth_millimetres(const DepthGeometry& geometry,
                                             const kernels::GrayImage& disparity) {
  std::vector<std::uint16_t> result(disparity.pixels.size(), 0);
  for_each_point(geometry, disparity, [&](int column, int row, const Eigen::Vector3d& point) {
    const double depth = std::floor(point.z() + 0.5);
    if (depth > std::numeric_limits<std::uint16_t>::max()) return;
    result[static_cast<std::size_t>(row) * static_cast<std::size_t>(disparity.width) +
           static_cast<std::size_t>(column)] = static_cast<std::uint16_t>(depth);
  });
  return result;
}

std::optional<DepthRange> depth_range(const std::vector<std::uint16_t>& millimetres) {
  std::vector<std::uint16_t> known;
  std::copy_if(millimetres.begin(), millimetres.end(), std::back_inserter(known),
               [](int depth) { return depth > 0; });
  if (known.empty()) return std::nullopt;
  std::sort(known.begin(), known.end());
  const int near = known[known.size() / 100];
  return DepthRange{near, std::max<int>(near + 1, known[known.size() - 1 - known.size() / 100])};
}

std::string point_cloud_ply(const DepthGeometry& geometry, const kernels::GrayImage& disparity,
                            const kernels::GrayImage& rectified_left) {
  if (rectified_left.width != disparity.width || rectified_left.height != disparity.height) {
    throw std::invalid_argument(
        fmt::format("rectified picture = {}x{}: must be as large as the disparities, {}x{}",
                    rectified_left.width, rectified_left.height, disparity.width, disparity.height));
  }
  std::string points;
  std::size_t count = 0;
  for_each_point(geometry, disparity, [&](int column, int row, const Eigen::Vector3d& point) {
    for (int axis = 0; axis < 3; ++axis) append(points, point[axis]);
    points.append(3, static_cast<char>(rectified_left.at(column, row)));
    ++count;
  });
  return "ply\nformat binary_little_endian 1.0\n"
         "comment millimetres, rectified left camera: x right, y down, z forward\n"
         "element vertex " +
         std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n" +
         points;
}

}  // namespace stereotlm::calib
