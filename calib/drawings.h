#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/grid_shape.h"
#include "models/kernels/gray_image.h"
#include "models/kernels/rectification_table.h"

// For the eye of someone who calibrates a rig, as PNG bytes; what belongs to the left camera is on the left.
// Pictures of up to 160 pixels each way are enlarged by a whole number, so that marks can be told apart. The
// same input gives the same bytes. An empty image, a table with problems and sides of different sizes are
// refused with std::invalid_argument.
namespace stereotlm::calib {

struct CaptionedImage {
  std::string caption;  // ASCII; drawn smaller, down to half, if it is wider than the image, then cut off
  kernels::GrayImage image;
};

struct MarkedCorners {
  Corners corners;  // as many as the chessboard has, inside the picture; or empty: it was not found
  std::vector<bool> left_out;  // one for each corner; or empty: all are used
};

// The corners as circles, each row in its colour, joined in their order, with a square around the first;
// those that are left out as red crosses.
std::vector<std::uint8_t> encode_corners_png(const GridShape& shape, const CaptionedImage& left,
                                             const MarkedCorners& left_corners, const CaptionedImage& right,
                                             const MarkedCorners& right_corners);

// Lines through both pictures along every 32nd row or so: a thing is in the same row on both sides.
std::vector<std::uint8_t> encode_rectified_pair_png(const CaptionedImage& left, const CaptionedImage& right);

// How far each entry is from its source, in colours (Turbo) from 0 to the largest distance of both tables;
// where no entry is valid, grey. Arrows from positions of the rectified picture to their sources.
std::vector<std::uint8_t> encode_displacement_png(const kernels::RectificationTable& left,
                                                  const kernels::RectificationTable& right);

// A chart of source_lines() for 1, 3, .. 31 lines, as far as the tables are high: the largest number of each
// table, and the mean.
std::vector<std::uint8_t> encode_source_lines_png(const kernels::RectificationTable& left,
                                                  const kernels::RectificationTable& right);

}  // namespace stereotlm::calib
