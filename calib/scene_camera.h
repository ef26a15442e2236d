#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/camera_model.h"
#include "calib/scene_surfaces.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

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

}  // namespace stereotlm::calib
