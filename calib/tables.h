#pragma once

#include "calib/rectification.h"
#include "models/kernels/rectification_table.h"

namespace stereotlm::calib {

struct TablePair {
  kernels::RectificationTable left;
  kernels::RectificationTable right;
};

// The tables of contract 1.1: each entry is the pixel of the camera's picture nearest to what is seen at that position
// of the rectified one (floor(x + 0.5)), valid if it lies inside. Column x of the left table is column
// x + disparity_offset of the rectified left picture. Throws std::invalid_argument if the pictures are larger than
// 2048 x 2048.
TablePair tables(const Rig& rig, const Rectification& rectification, int disparity_offset);

}  // namespace stereotlm::calib
