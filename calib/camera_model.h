#pragma once

#include <Eigen/Core>
#include <array>

namespace stereotlm::calib {

// A pinhole camera behind a lens with OpenCV's five coefficients (Brown, 1966). Camera coordinates: x right,
// y down, z forward, in mm. A direction is (x/z, y/z). Pixel coordinates: (0, 0) is the middle of the top
// left pixel.
struct CameraModel {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();  // fx 0 cx; 0 fy cy; 0 0 1, pixels
  std::array<double, 5> distortion{};                    // k1, k2 (radial), p1, p2 (tangential), k3 (radial)

  // The largest distance from the axis (length of a direction) up to which the lens maps directions one to
  // one; at most 10. Beyond it the polynomial bends the picture back into itself, which no lens does.
  double widest() const;

  // The pixel at which a direction is seen. Beyond widest() the result follows the polynomial, although no
  // lens does.
  Eigen::Vector2d pixel(const Eigen::Vector2d& direction) const;

  // The direction that is seen at a pixel. Throws std::domain_error if the lens model does not map a
  // direction one to one to this pixel.
  Eigen::Vector2d direction(const Eigen::Vector2d& pixel) const;
};

}  // namespace stereotlm::calib
