#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calib/rig_fit.h"

namespace stereotlm::calib {

// The pose of the grid, which maps grid coordinates to camera coordinates of the left camera. It minimises
// the squared distances, in the pictures of both cameras, between the used corners as found and their
// positions under this pose (Gauss-Newton).
Eigen::Isometry3d grid_pose(const Rig& rig, const GridShape& shape, const GridPair& pair,
                            const std::vector<bool>& used);

}  // namespace stereotlm::calib
