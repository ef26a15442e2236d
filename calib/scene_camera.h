#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/camera_model.h"
#include "calib/scene_surfaces.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

// A camera at a place of the scene, with a lens that is not quite sharp. It keeps a ray for every pixel: they
// cost more to find than most pictures.
class SceneCamera {
 public:
  // `to_scene`: from directions in camera coordinates to those in the scene's. Throws as
  // CameraModel::direction.
  SceneCamera(const CameraModel& model, const Eigen::Vector3d& place, const Eigen::Matrix3d& to_scene,
              int width, int height);

  const Eigen::Vector3d& place() const { return place_; }

  // Every pixel is a mean; where an edge crosses it, of 64 samples. The rays are exact through the corners of
  // the pixels and interpolated between them, at 320 x 240 less than 0.001 pixels off.
  kernels::GrayImage picture(const SceneSurfaces& surfaces) const;

 private:
  struct Corner;

  // Of a row of pixels.
  std::vector<Corner> corners_above(int row, const SceneSurfaces& surfaces) const;
  // Of the pixel between the corners a and b above, c and d below.
  double level(const SceneSurfaces& surfaces, const Corner& a, const Corner& b, const Corner& c,
               const Corner& d) const;

  int width_;
  int height_;
  Eigen::Vector3d place_;
  Eigen::Matrix3d to_scene_;
  std::vector<Eigen::Vector2f> directions_;  // (width + 1) x (height + 1) corners of pixels, row by row
};

}  // namespace stereotlm::calib
