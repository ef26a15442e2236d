#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calib/rig_fit.h"

namespace stereotlm::calib {

// Where the grid is, from its own coordinates to those of the left camera, such that the corners used are
// seen nearest to where they were found: least squares over both cameras (Gauss-Newton).
Eigen::Isometry3d grid_pose(const Rig& rig, const GridShape& shape, const GridPair& pair,
                            const std::vector<bool>& used);

}  // namespace stereotlm::calib
