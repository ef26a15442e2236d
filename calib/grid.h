#pragma once

#include <optional>
#include <string>

#include "calib/grid_shape.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

struct GridSearch {
  std::optional<Corners> corners;
  std::string problem;  // why there are no corners: "no grid of 9x6 inner corners found"
};

// Finds the corners of the chessboard in a picture, to a fraction of a pixel. A chessboard with more corners
// than `shape` counts as not found, because it is unknown which of its corners were found.
GridSearch find_grid(const kernels::GrayImage& picture, const GridShape& shape);

// Whether these are all inner corners of the chessboard in the picture. OpenCV also finds part of a board,
// without lines at its border or in between. The check uses the greys around the corners, and around the
// places where the next corners would be.
bool are_all_of_board(const kernels::GrayImage& picture, const GridShape& shape, const Corners& corners);

// Moves each corner to the nearby point where the greys form a saddle. The window reaches 30 % of the
// smallest distance between neighbours to every side, and at least 2 pixels. A larger window would contain
// the next corner, which shifts the result by pixels where the board is far or tilted.
Corners refined(const kernels::GrayImage& picture, const GridShape& shape, const Corners& corners);

// The search cannot distinguish a chessboard from one that is turned by half (a square one by a quarter).
// Returns the corners in the order whose directions agree best with `other`, the corners that another camera
// of the rig sees.
Corners ordered_like(const Corners& other, const GridShape& shape, const Corners& corners);

}  // namespace stereotlm::calib
