#pragma once

#include <string>

#include "calib/rig.h"

namespace stereotlm::calib {

// A page with a chessboard, and below it a ruler of 100 mm and a line of small print. The square in the
// corner at the top left is black.
struct GridSheet {
  double width_mm = 0;
  double height_mm = 0;
  // The top left corner of the squares, from the top left corner of the page.
  double board_left_mm = 0;
  double board_top_mm = 0;
};

// Let m be half a square, at least 10 mm. The page is the first of A4 landscape, A4 portrait, A3 landscape
// and A3 portrait that leaves a white margin of m around the board. If none does, it is the first that leaves
// 10 mm. If none does that, it is as large as the board with the margin m, and at least as wide as A4. Throws
// std::invalid_argument with all problems(shape), or if the page would exceed the 5080 mm (14400 pt) of PDF.
GridSheet grid_sheet(const GridShape& shape);

// Files as bytes, to be printed at 100 %. Every edge is within 1/1000 mm of its place. The same shape gives
// the same bytes. Both throw as grid_sheet() does.
std::string grid_sheet_pdf(const GridShape& shape);
std::string grid_sheet_svg(const GridShape& shape);

}  // namespace stereotlm::calib
