#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/grid_shape.h"
#include "calib/rectification.h"
#include "calib/rig.h"
#include "calib/scene_camera.h"
#include "calib/scene_surfaces.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

// Two cameras that are known exactly, and what they see: chessboards to calibrate them with, and a scene of a
// wall, a floor, a slanted board and spheres, all textured. The same for a seed on every machine, as far as
// floating point allows.
//
// The cameras are about 80 mm apart and see some 68 degrees across (51 down if the picture is taller than 3:4
// of its width), through wide-angle lenses, not quite in parallel. The disparities of the scene, once
// rectified, are 1/34 to 1/9 of the picture's width (of 4/3 of its height if that is more): about 20 to 65
// pixels at 640 x 480. They grow with the picture.
class SyntheticRig {
 public:
  // Throws std::invalid_argument unless width is 4..2048, a multiple of 4, and height 1..2048.
  SyntheticRig(std::uint64_t seed, int width, int height);

  const Rig& rig() const { return rig_; }

  struct Pair {
    kernels::GrayImage left;
    kernels::GrayImage right;
  };
  struct CornerPair {
    Corners left;
    Corners right;
  };

  // The chessboard with a white border, before a grey background, in pose `number`, 0, 1, ..: near enough to
  // fill a good part of the pictures, as far as both cameras then see it, tilted from the line of sight by 10
  // to 35 degrees, rolled, and every square wholly inside both pictures. A dozen poses calibrate the rig.
  // Throws std::invalid_argument for columns or rows outside 1..1000, squares that are not larger than 0 mm
  // or a negative number, std::domain_error if the pictures have no room for it (a picture of a few rows).
  Pair grid_view(const GridShape& shape, int number) const;
  // Where the pictures of grid_view() show the inner corners, exactly. Throws as grid_view().
  CornerPair grid_corners(const GridShape& shape, int number) const;

  Pair scene() const;
  // What a position of the scene's left picture shows, in camera coordinates of the left camera, mm. Nothing
  // if it is outside the picture, or if nothing is there.
  std::optional<Eigen::Vector3d> point(const Eigen::Vector2d& left_pixel) const;
  // Where the right camera sees that point. Nothing if there is none, if it is hidden from the right camera,
  // or outside its picture.
  std::optional<Eigen::Vector2d> match(const Eigen::Vector2d& left_pixel) const;

  // What a board that uses a calibration of this rig should find in the scene: for every pixel of its output,
  // row by row, its column less that of its match in the rectified right picture. Column u of the output is
  // column u + disparity_offset of the rectified left picture, so the true disparity is disparity_offset
  // more. NaN where there is no match. The calibration may be recovered, and then differ from rig(): the
  // pixels match in the cameras' own pictures, `calibrated` and its `rectification` say where they are in the
  // rectified ones. Throws std::invalid_argument if the pictures of `calibrated` have another size, else as
  // rectified_pixel().
  std::vector<float> disparity(const Rig& calibrated, const Rectification& rectification,
                               int disparity_offset) const;

 private:
  // From chessboard coordinates to those of the left camera.
  Eigen::Isometry3d grid_pose(const GridShape& shape, int number) const;
  std::optional<CornerPair> seen(const std::vector<Eigen::Vector3d>& points) const;

  std::uint64_t seed_;
  Rig rig_;
  SceneCamera left_;  // the coordinates of the scene are the left camera's
  SceneCamera right_;
  SceneSurfaces scene_;
};

}  // namespace stereotlm::calib
