#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "calib/rig.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::media {

namespace made_rig {
struct View;  // the scene, and the cameras
}

// A rig whose parameters are known exactly. It renders pictures of grids, to calibrate the cameras, and
// of a textured scene: a wall, a floor, a slanted panel and spheres. The same seed gives the same pictures on
// every machine, within floating-point accuracy.
//
// The cameras are about 80 mm apart and not quite parallel. Let w be the width of the smallest 4:3 picture
// that contains theirs. The wide-angle lenses see about 68 degrees over the width w, and 51 degrees over the
// height 3/4 w. The rectified disparities of the scene are about w/34 to w/9.5: 19 to 67 pixels at 640 x 480.
class SyntheticRig {
 public:
  // `width` and `height`: of the pictures, at least one pixel.
  SyntheticRig(std::uint64_t seed, int width, int height);

  const calib::Rig& rig() const { return rig_; }

  struct Pair {
    kernels::GrayImage left;
    kernels::GrayImage right;
  };

  // The pictures of the grid, with a white border before a grey background, in pose `number`: 0, 1, .. The
  // grid fills a good part of both pictures. It is tilted from the line of sight by 10 to 35
  // degrees, and rolled. Every square lies wholly inside both pictures. A dozen poses suffice to calibrate
  // the rig. `shape` has no problems(). Throws std::domain_error if the pictures have no room for the board,
  // such as pictures of a few rows.
  Pair grid_view(const calib::GridShape& shape, int number) const;
  // The exact positions of the grid's corners in the pictures of grid_view(). Throws as grid_view() does.
  calib::GridPair grid_corners(const calib::GridShape& shape, int number) const;

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
  // Matches are found with rig(), in the pictures of the cameras. `calibrated` and `rectification` only map
  // positions between these pictures and the rectified ones. So `calibrated` may be a rig that was fitted to
  // pictures of rig(). Throws as rectified_pixel() does.
  std::vector<float> disparity(const calib::Rig& calibrated, const calib::Rectification& rectification,
                               int disparity_offset) const;

 private:
  std::uint64_t seed_;
  calib::Rig rig_;
  std::shared_ptr<const made_rig::View> view_;
};

// Ground truth as a picture that can be written.
struct GreyTruth {
  kernels::GrayImage grey;
  int scale = 1;  // grey levels per disparity
};

// Disparities of pictures `width` pixels wide as ground truth, for a board with this number of `disparities`:
// with as many grey levels per disparity as 255 levels allow. A disparity beyond them is unknown.
GreyTruth truth_of(const std::vector<float>& disparity, int width, int disparities);

}  // namespace stereotlm::media
