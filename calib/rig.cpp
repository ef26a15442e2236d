#include "calib/rig.h"

#include <Eigen/Geometry>

namespace stereotlm::calib {

SeenPoint seen_by(const Rig& rig, const Eigen::Vector3d& point) {
  const Eigen::Vector3d to_right = rig.rotation * point + rig.translation;
  return {rig.left.pixel(point.hnormalized()), rig.right.pixel(to_right.hnormalized())};
}

}  // namespace stereotlm::calib
