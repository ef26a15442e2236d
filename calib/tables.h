#pragma once

#include <cstdint>

#include "calib/rectification.h"
#include "models/kernels/rectification_table.h"

namespace stereotlm::calib {

struct TablePair {
  kernels::RectificationTable left;
  kernels::RectificationTable right;
};

// The entry of contract 1.1 for a position of the rectified picture: the nearest pixel of the camera's
// picture (floor(x + 0.5)), valid if it lies inside the picture.
std::uint32_t table_entry(const Rig& rig, const SourcePixels& sources, const Eigen::Vector2d& rectified);

// Column x of the left table is column x + disparity_offset of the rectified left picture. Throws
// std::invalid_argument if the pictures are larger than 2048 x 2048.
TablePair tables(const Rig& rig, const Rectification& rectification, int disparity_offset);

// Whether tables() would make the same tables. They must have the size of the rig's pictures. Compares about
// one entry in a hundred.
bool are_tables_of(const TablePair& tables, const Rig& rig, const Rectification& rectification,
                   int disparity_offset);

}  // namespace stereotlm::calib
