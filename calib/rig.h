#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace stereotlm::calib {

inline constexpr double kDegrees = 57.29577951308232;  // of a radian

// A pinhole camera behind a lens of one of OpenCV's models: polynomial (Brown, 1966), rational, with a thin
// prism, or fisheye (Kannala and Brandt, 2006). Camera coordinates: x right, y down, z forward, in mm. A
// direction is (x/z, y/z). Pixel coordinates: (0, 0) is the middle of the top left pixel.
struct CameraModel {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();  // fx 0 cx; 0 fy cy; 0 0 1, pixels
  // k1, k2 (radial), p1, p2 (tangential), k3, k4, k5, k6 (radial), s1, s2, s3, s4 (prism). Of a fisheye lens
  // the first four are its k1, k2, k3, k4, and the others are 0.
  std::array<double, 12> distortion{};
  bool is_fisheye = false;

  // The number of coefficients that a file needs: 4 of a fisheye lens, else 5, or 8 or 12 if the others are
  // not 0.
  std::size_t coefficients() const;

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

// Two cameras on one bar, with pictures of one size.
struct Rig {
  int width = 0;   // pixels
  int height = 0;  // pixels
  CameraModel left;
  CameraModel right;
  // Camera coordinates of a point: right = rotation * left + translation, mm.
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  // By how much one camera is turned about its axis against the other, 0..180 degrees.
  double roll_deg() const;
};

inline constexpr double kMostRoll = 45;  // degrees of a rig for a board

// Why the cameras cannot be those of a board, which stand side by side, upright, the left one first, and are
// of one kind. Nullopt if they can.
std::optional<std::string> problem_of(const Rig& rig);

// The pixels at which the two cameras see a point, which is in camera coordinates of the left camera.
struct SeenPoint {
  Eigen::Vector2d left;
  Eigen::Vector2d right;
};

SeenPoint seen_by(const Rig& rig, const Eigen::Vector3d& point);

using Projection = Eigen::Matrix<double, 3, 4>;

// Two ideal cameras that replace the cameras of a rig. They have parallel axes, the same focal length and the
// same principal point, and see a point in the same row. The names are those of OpenCV's stereoRectify.
struct Rectification {
  // r1 (r2) maps camera coordinates of the left (right) camera to camera coordinates of its ideal camera.
  Eigen::Matrix3d r1 = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d r2 = Eigen::Matrix3d::Identity();
  // p1 (p2) maps camera coordinates of the ideal left camera to pixels of the left (right) rectified picture.
  Projection p1 = Projection::Zero();
  Projection p2 = Projection::Zero();
  // q maps (column, row, true disparity, 1) of the rectified left picture to homogeneous camera coordinates
  // of the ideal left camera, in mm.
  Eigen::Matrix4d q = Eigen::Matrix4d::Zero();
};

// Rectification::q, as OpenCV's stereoRectify computes it.
Eigen::Matrix4d disparity_to_depth(const Projection& p1, const Projection& p2);

// Rectifies a rig. The rectified pictures have the size of the rig's pictures, and contain only pixels that
// the cameras saw.
Rectification rectify(const Rig& rig);

// Maps a pixel of a camera's picture to its position in the rectified picture. `rotation` and `projection`
// are r1 and p1, or r2 and p2. Throws as CameraModel::direction() does.
Eigen::Vector2d rectified_pixel(const CameraModel& camera, const Eigen::Matrix3d& rotation,
                                const Projection& projection, const Eigen::Vector2d& pixel);

// The inverse of rectified_pixel(): maps a position of the rectified picture to the pixel of the camera's
// picture that is seen there. at() returns nullopt if the position is behind the camera, or beyond the view
// of its lens (CameraModel::widest()).
class SourcePixels {
 public:
  SourcePixels(const CameraModel& camera, const Eigen::Matrix3d& rotation, const Projection& projection);
  std::optional<Eigen::Vector2d> at(const Eigen::Vector2d& rectified) const;

 private:
  CameraModel camera_;
  Eigen::Matrix3d from_rectified_;
  double widest_;
};

// The pattern of a calibration grid. Circles are dark on a bright ground. Asymmetric circles are those of
// OpenCV: every other row is shifted by half the distance between two circles of a row.
enum class Pattern { kChessboard, kCircles, kAsymmetricCircles };

// The names in options and files, in the order of Pattern.
inline constexpr std::array<const char*, 3> kPatternNames = {"chessboard", "circles", "asymmetric_circles"};
std::optional<Pattern> pattern_named(const std::string& name);

// A calibration grid of `columns` x `rows` corners: the inner corners of a chessboard, where four squares
// meet, or the centres of circles, which are called corners too.
struct GridShape {
  int columns = 0;  // 3..100
  int rows = 0;     // 3..100; odd if the circles are asymmetric
  // 1..1000: a side of a square, or the distance between two rows of circles. Asymmetric circles of one row
  // are twice as far apart.
  double square_mm = 0;
  Pattern pattern = Pattern::kChessboard;

  int corners() const { return columns * rows; }
  // "9x6 inner corners", or "4x11 circles".
  std::string text() const;
  // The width and height that the corners span, in units of square_mm.
  Eigen::Vector2d extent() const;
};

// Every broken rule, as `field = value: rule`.
std::vector<std::string> problems(const GridShape& shape);

// The corners on the grid, row by row, z = 0, in mm; the first is the origin. The corner (column, row) is at
// (column, row) * square_mm; that of asymmetric circles at (2 * column + row % 2, row) * square_mm.
std::vector<Eigen::Vector3d> corner_points(const GridShape& shape);

// The corners in one picture, in the order of corner_points(), in pixels.
using Corners = std::vector<Eigen::Vector2d>;

// The corners that both cameras see in one position of the grid.
struct GridPair {
  Corners left;
  Corners right;
};

}  // namespace stereotlm::calib
