#pragma once

#include <optional>
#include <string>

#include "calib/grid_shape.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

struct GridSearch {
  std::optional<Corners> corners;
  std::string problem;  // why there are none: "no grid of 9x6 inner corners found"
};

// The corners of the chessboard in a picture, to a fraction of a pixel. One that has more corners than
// `shape` is refused: nobody could say which of them were found.
GridSearch find_grid(const kernels::GrayImage& picture, const GridShape& shape);

// Whether corners are all inner corners of the chessboard in the picture: OpenCV also finds part of a board,
// with lines at its border or in between left out. Judged by the greys around the corners, and around those
// that would be next.
bool are_all_of_board(const kernels::GrayImage& picture, const GridShape& shape, const Corners& corners);

// Each corner moved to the point near it where the greys form a saddle. The window that decides reaches 30 %
// of the smallest distance between neighbours to every side, at least 2 pixels: a larger one sees the next
// corner, which pulls by pixels where the board is far or tilted.
Corners refined(const kernels::GrayImage& picture, const GridShape& shape, const Corners& corners);

// A chessboard looks the same turned by half (a square one by a quarter) to whoever finds its corners: these
// corners in the order that runs in most nearly the direction of `other`, which another camera of the rig
// sees.
Corners ordered_like(const Corners& other, const GridShape& shape, const Corners& corners);

}  // namespace stereotlm::calib
