#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "calib/rig.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

// The points origin + t * direction, t > 0. Lengths of the scene are in mm.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;

  Eigen::Vector3d at(double t) const { return origin + t * direction; }
};

// A surface in front of the cameras.
struct Surface {
  std::function<double(const Ray&)> meets;  // t of the first point of the ray; infinite if there is none
  std::function<double(const Eigen::Vector3d&)> level;  // the grey level of a point on it, 0..255
};

// All surfaces of a scene.
class SceneSurfaces {
 public:
  // `background` is the grey level of a ray that meets no surface.
  SceneSurfaces(std::vector<Surface> surfaces, double background)
      : surfaces_(std::move(surfaces)), background_(background) {}

  // The first point of a ray on a surface; nullopt if it meets none.
  std::optional<Eigen::Vector3d> first(const Ray& ray) const;
  // Whether no surface lies between the eye and `point`, which is on a surface.
  bool visible(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) const;
  // The grey level that is seen along a ray.
  double level(const Ray& ray) const;

 private:
  struct Nearest {
    const Surface* surface;  // null if there is none
    double t;
  };

  Nearest nearest(const Ray& ray) const;

  std::vector<Surface> surfaces_;
  double background_;
};

// Renders the pictures of a camera of SyntheticRig, from one place in the scene and slightly blurred. It
// stores the direction of the ray at every corner of a pixel, because computing the directions takes longer
// than rendering most pictures.
class SceneCamera {
 public:
  // `to_scene` turns directions in camera coordinates to scene coordinates. Throws as
  // CameraModel::direction() does.
  SceneCamera(const CameraModel& model, const Eigen::Vector3d& place, const Eigen::Matrix3d& to_scene,
              int width, int height);

  const Eigen::Vector3d& place() const { return place_; }

  // Every pixel is a mean of samples: of 64 if an edge crosses it, else of five. The rays are exact at the
  // corners of the pixels and interpolated between them, with an error below 0.001 pixels at 320 x 240.
  kernels::GrayImage picture(const SceneSurfaces& surfaces) const;

 private:
  struct Corner;

  // The corners above a row of pixels.
  std::vector<Corner> corners_above(int row, const SceneSurfaces& surfaces) const;
  // The grey level of the pixel whose upper corners are a and b, and whose lower corners are c and d.
  double level(const SceneSurfaces& surfaces, const Corner& a, const Corner& b, const Corner& c,
               const Corner& d) const;

  int width_;
  int height_;
  Eigen::Vector3d place_;
  Eigen::Matrix3d to_scene_;
  std::vector<Eigen::Vector2f> directions_;  // (width + 1) x (height + 1) corners of pixels, row by row
};

// A rig whose parameters are known exactly. It renders pictures of chessboards, to calibrate the cameras, and
// of a textured scene: a wall, a floor, a slanted panel and spheres. The same seed gives the same pictures on
// every machine, within floating-point accuracy.
//
// The cameras are about 80 mm apart and not quite parallel. Let w be the width of the smallest 4:3 picture
// that contains theirs. The wide-angle lenses see about 68 degrees over the width w, and 51 degrees over the
// height 3/4 w. The rectified disparities of the scene are w/34 to w/9, such as about 20 to 65 pixels at 640
// x 480.
class SyntheticRig {
 public:
  // `width` and `height`: of the pictures, at least one pixel.
  SyntheticRig(std::uint64_t seed, int width, int height);

  const Rig& rig() const { return rig_; }

  struct Pair {
    kernels::GrayImage left;
    kernels::GrayImage right;
  };

  // The pictures of the chessboard, with a white border before a grey background, in pose `number`: 0, 1, ..
  // The chessboard fills a good part of both pictures. It is tilted from the line of sight by 10 to 35
  // degrees, and rolled. Every square lies wholly inside both pictures. A dozen poses suffice to calibrate
  // the rig.
  // `shape` has no problems(). Throws std::domain_error if the pictures have no room for the board, such as
  // pictures of a few rows.
  Pair grid_view(const GridShape& shape, int number) const;
  // The exact positions of the inner corners in the pictures of grid_view(). Throws as grid_view() does.
  GridPair grid_corners(const GridShape& shape, int number) const;

  // The pictures of the scene.
  Pair scene() const;
  // The point that a position of the scene's left picture shows, in camera coordinates of the left camera, in
  // mm. Nullopt if the position is outside the picture, or shows no surface.
  std::optional<Eigen::Vector3d> point(const Eigen::Vector2d& left_pixel) const;
  // The pixel at which the right camera sees that point. Nullopt if there is no point, if it is hidden from
  // the right camera, or if it lies outside the right picture.
  std::optional<Eigen::Vector2d> match(const Eigen::Vector2d& left_pixel) const;

  // The disparities that the FPGA board should find in the scene with the calibration `calibrated`, row by
  // row; NaN where a pixel has no match. Column u of the board's left picture is column u + disparity_offset
  // of the rectified left picture. A returned value is u less the column of the match in the rectified right
  // picture; the true disparity is this value + disparity_offset.
  //
  // Matches are found with rig(), in the pictures of the cameras. `calibrated` and its `rectification` map
  // them to the rectified pictures. So `calibrated` may be a rig that was fitted to pictures of that size.
  // Throws as rectified_pixel() does.
  std::vector<float> disparity(const Rig& calibrated, const Rectification& rectification,
                               int disparity_offset) const;

 private:
  // From chessboard coordinates to coordinates of the left camera.
  Eigen::Isometry3d grid_pose(const GridShape& shape, int number) const;
  std::optional<GridPair> seen(const std::vector<Eigen::Vector3d>& points) const;

  std::uint64_t seed_;
  Rig rig_;
  SceneCamera left_;  // scene coordinates are those of the left camera
  SceneCamera right_;
  SceneSurfaces scene_;
};

}  // namespace stereotlm::calib
