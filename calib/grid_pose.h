#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calib/rig_fit.h"

namespace stereotlm::calib {

// The pose of the grid, which maps its own coordinates to those of the left camera. It minimises the squared
// distances, in the pictures of both cameras, from the used corners as found to their positions under that
// pose (Gauss-Newton).
Eigen::Isometry3d grid_pose(const Rig& rig, const GridShape& shape, const GridPair& pair,
                            const std::vector<bool>& used);

}  // namespace stereotlm::calib
