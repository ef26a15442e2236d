#pragma once

#include <optional>
#include <string>

#include "calib/rig.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

// The result of find_grid().
struct GridSearch {
  std::optional<Corners> corners;
  std::string problem;  // why there are no corners: "no grid of 9x6 inner corners found"
};

// Finds the corners of the grid in a picture, to a fraction of a pixel. A grid with more corners than `shape`
// counts as not found, because it is unknown which of its corners were found. Takes about 2 s at most, also
// with 2048x2048 pixels of noise.
//
// The sense of rotation of the corners is always the same: in the picture, a turn from the direction of the
// rows to that of the columns is clockwise. So it does not tell whether the picture is mirrored: in a
// mirrored picture, the corners are in another order than on the grid, with the rows or the columns reversed.
GridSearch find_grid(const kernels::GrayImage& picture, const GridShape& shape);

// Finds the corners of the grid in a picture in which they are expected near the corners `near`, in the same
// order: those of a chessboard by refined(), circles by find_grid(). Returns nullopt if it finds no circles.
std::optional<Corners> found_near(const kernels::GrayImage& picture, const GridShape& shape,
                                  const Corners& near);

// Whether `corners` are all inner corners of the chessboard in the picture. OpenCV may find only a part of a
// board, without some lines of corners at the border or inside. The check uses the greys around the corners,
// and around the places where further corners would be.
bool are_all_of_board(const kernels::GrayImage& picture, const GridShape& shape, const Corners& corners);

// Moves each corner to the nearby point where the greys form a saddle. The window reaches 30 % of the
// smallest distance between neighbours to every side, and at least 2 pixels. A larger window would contain
// the next corner. That would shift the result by pixels if the board is far or tilted.
Corners refined(const kernels::GrayImage& picture, const GridShape& shape, const Corners& corners);

// find_grid() cannot distinguish a grid from the same one turned by 180 degrees (by 90 degrees if it is
// square). Returns `corners` in the order in which the directions of rows and columns agree best with those
// of `other`, the corners that another camera of the rig sees. Asymmetric circles have one order only.
Corners ordered_like(const Corners& other, const GridShape& shape, const Corners& corners);

}  // namespace stereotlm::calib
