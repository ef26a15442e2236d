#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calib/rig_fit.h"

namespace stereotlm::calib {

// The pose of the grid: from its own coordinates to those of the left camera. It minimises the squared
// distances, over both cameras, between where the used corners were found and where they would be seen
// (Gauss-Newton).
Eigen::Isometry3d grid_pose(const Rig& rig, const GridShape& shape, const GridPair& pair,
                            const std::vector<bool>& used);

}  // namespace stereotlm::calib
