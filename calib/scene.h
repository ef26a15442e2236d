#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "calib/rig.h"
#include "models/kernels/gray_image.h"

// The surfaces in front of the cameras of a synthetic rig, and pictures of them. Lengths are in mm.
namespace stereotlm::calib {

// The points origin + t * direction, t > 0.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;

  Eigen::Vector3d at(double t) const { return origin + t * direction; }
};

// A grey level, 0..255, for every position on a surface. The surface defines the unit of length.
using Texture = std::function<double(const Eigen::Vector2d& position)>;

// Smooth noise around a level, with details of one, two, four and eight units. It is flat nowhere.
Texture noise(std::uint64_t seed, double level);

// A chessboard on white. The unit is a square and the first inner corner is the origin; the square above and
// to the left of it is black.
Texture chessboard(const GridShape& shape);

// A textured rectangle. `origin` is the origin of its texture. The vectors `across` and `down`, at right
// angles, are one unit of the texture each. `extent` is the rectangle in these units. Both sides look the
// same.
class Plane {
 public:
  Plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& across, const Eigen::Vector3d& down,
        const Eigen::AlignedBox2d& extent, Texture texture);

  // t of the first point of the ray on this surface; infinite if there is none.
  double meets(const Ray& ray) const;
  // The grey level of a point on the surface.
  double level(const Eigen::Vector3d& point) const { return texture_(position(point)); }

 private:
  Eigen::Vector2d position(const Eigen::Vector3d& point) const;

  Eigen::Vector3d origin_;
  Eigen::Vector3d normal_;
  Eigen::Vector3d to_across_;
  Eigen::Vector3d to_down_;
  Eigen::AlignedBox2d extent_;
  Texture texture_;
};

// A sphere whose texture is projected from far away along the z axis, so that it looks as fine at the rim as
// in the middle. A unit of the texture is `unit_mm`.
class Sphere {
 public:
  Sphere(const Eigen::Vector3d& centre, double radius, double unit_mm, Texture texture);

  // As in Plane.
  double meets(const Ray& ray) const;
  double level(const Eigen::Vector3d& point) const;

 private:
  Eigen::Vector3d centre_;
  double radius_;
  double unit_mm_;
  Texture texture_;
};

// All surfaces of a scene.
class SceneSurfaces {
 public:
  // `background` is the grey level of a ray that meets no surface.
  SceneSurfaces(std::vector<std::variant<Plane, Sphere>> surfaces, double background);

  // The first point of a ray on a surface; nullopt if it meets none.
  std::optional<Eigen::Vector3d> first(const Ray& ray) const;
  // Whether no surface lies between the eye and `point`, which is on a surface.
  bool visible(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) const;
  // The grey level that is seen along a ray.
  double level(const Ray& ray) const;

 private:
  using Surface = std::variant<Plane, Sphere>;
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

}  // namespace stereotlm::calib
