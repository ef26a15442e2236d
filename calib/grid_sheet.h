#pragma once

#include <string>

#include "calib/rig.h"

namespace stereotlm::calib {

// A page with a chessboard to be printed at 100 %, as SVG in millimetres. Below the board it has a ruler of
// 100 mm and a line of small print. The square at the top left is black. Every edge is within 1/1000 mm of
// its place. `shape` has no problems().
//
// Let m be half a square, but at least 10 mm. The page is the first of A4 landscape, A4 portrait, A3
// landscape and A3 portrait that leaves a white margin of m around the board. If none does, it is the first
// that leaves 10 mm. If none does that, it is as large as the board with the margin m, and at least as wide
// as A4.
std::string grid_sheet_svg(const GridShape& shape);

}  // namespace stereotlm::calib
