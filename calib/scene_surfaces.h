#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "calib/grid_shape.h"

// What the cameras of a synthetic rig look at. Lengths are in mm.
namespace stereotlm::calib {

// The points origin + t * direction, t > 0.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;

  Eigen::Vector3d at(double t) const { return origin + t * direction; }
};

// A grey level, 0..255, for every position on a surface; what a unit of length is, the surface says.
using Texture = std::function<double(const Eigen::Vector2d& position)>;

// Smooth noise of four sizes, one unit and two, four and eight, around a level: nowhere flat, and no detail
// finer than a unit.
Texture noise(std::uint64_t seed, double level);

// A unit is a square, the first inner corner is the origin, and the square above and to the left of it is
// black. White around the squares.
Texture chessboard(const GridShape& shape);

// `across` and `down` are a unit of the texture: at right angles, from the origin of the texture. The plane
// ends where `extent`, in units of the texture, does. Both sides look the same.
class Plane {
 public:
  Plane(const Eigen::Vector3d& origin, const Eigen::Vector3d& across, const Eigen::Vector3d& down,
        const Eigen::AlignedBox2d& extent, Texture texture);

  // t of the first point, infinite if there is none.
  double meets(const Ray& ray) const;
  // Of a point on the surface.
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

// Painted as by a projector far away on the z axis, `unit_mm` to a unit of the texture: it looks as fine at
// the rim as in the middle.
class Sphere {
 public:
  Sphere(const Eigen::Vector3d& centre, double radius, double unit_mm, Texture texture);

  // As those of a plane.
  double meets(const Ray& ray) const;
  double level(const Eigen::Vector3d& point) const;

 private:
  Eigen::Vector3d centre_;
  double radius_;
  double unit_mm_;
  Texture texture_;
};

class SceneSurfaces {
 public:
  // `background`: the level where there is nothing.
  SceneSurfaces(std::vector<std::variant<Plane, Sphere>> surfaces, double background);

  // The first point on a ray.
  std::optional<Eigen::Vector3d> first(const Ray& ray) const;
  // Whether nothing lies between the two; `point` is on a surface.
  bool visible(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) const;
  // What is seen along a ray.
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

}  // namespace stereotlm::calib
