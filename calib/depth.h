#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/calibration.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

// Converts disparities of the board to millimetres. Points are in camera coordinates of the ideal left
// camera: x right, y down, z forward, mm.
struct DepthGeometry {
  Eigen::Matrix4d q = Eigen::Matrix4d::Zero();  // Rectification::q
  int disparity_offset = 0;  // offset that the left table subtracts from columns and disparities

  // The point that the board's output shows at (column, row) with this disparity. `column` and `row` need not
  // be whole numbers. Nullopt if the point is not in front of the camera at a finite distance.
  std::optional<Eigen::Vector3d> point(double column, double row, double disparity) const;
};

// The depth in mm at which an object in the middle of the picture has this disparity of the board. Nullopt if
// it is infinitely far away.
std::optional<double> depth_in_the_middle(const Calibration& calibration, int disparity);

// The disparity of the board's output, not rounded, of a point at this depth in mm.
double disparity_at(const DepthGeometry& geometry, double depth_mm);

// Depth (z) of each pixel of the board's output, row by row, to the nearest millimetre. It is 0 where there
// is no disparity, or where the depth is less than half a millimetre or above 65535.
std::vector<std::uint16_t> depth_millimetres(const DepthGeometry& geometry,
                                             const kernels::GrayImage& disparity);

// The nearest and the farthest depth that a coloured picture distinguishes. One hundredth of all known depths
// is nearer, another is farther. Nullopt if no depth is known.
struct DepthRange {
  int near_mm = 0;
  int far_mm = 0;  // above near_mm
};
std::optional<DepthRange> depth_range(const std::vector<std::uint16_t>& millimetres);

// The points of all pixels with a disparity as a PLY file (binary, little endian): x, y, z in mm as floats,
// and the grey of the pixel of `rectified_left` as red, green, blue. Throws std::invalid_argument if the
// images differ in size.
std::string point_cloud_ply(const DepthGeometry& geometry, const kernels::GrayImage& disparity,
                            const kernels::GrayImage& rectified_left);

}  // namespace stereotlm::calib
