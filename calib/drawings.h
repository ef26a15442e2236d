#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/rig.h"
#include "models/kernels/gray_image.h"
#include "models/kernels/rectification_table.h"

// Drawings for a person who calibrates a rig, as PNG bytes. The left half of each drawing belongs to the left
// camera. The same input gives the same bytes. Both sides have the same size, and are not empty.
namespace stereotlm::calib {

struct CaptionedImage {
  std::string caption;  // if wider than the image, shrunk to half the size at most, then cut off
  kernels::GrayImage image;
};

struct MarkedCorners {
  Corners corners;             // all corners of the chessboard; empty if it was not found
  std::vector<bool> left_out;  // one per corner; empty if all are used
};

// Draws the corners as circles, each row in its colour, joined in their order, with a square around the
// first. Corners that are left out are red crosses.
std::vector<std::uint8_t> encode_corners_png(const GridShape& shape, const CaptionedImage& left,
                                             const MarkedCorners& left_corners, const CaptionedImage& right,
                                             const MarkedCorners& right_corners);

// Draws lines through both pictures along every 32nd row. Objects lie in the same row on both sides.
std::vector<std::uint8_t> encode_rectified_pair_png(const CaptionedImage& left, const CaptionedImage& right);

// Draws the displacement from each entry to its source, less the mean of its table, which the caption gives.
// Colours (Viridis) show the length of the difference, from 0 to the largest of both tables; light grey: the
// entry is not valid. Arrows show its direction. Their scale is in the captions. It is the same for both
// tables, and such that no arrow reaches the next.
std::vector<std::uint8_t> encode_displacement_png(const kernels::RectificationTable& left,
                                                  const kernels::RectificationTable& right);

// Draws depths in colours (Viridis), near ones bright, with the scale below. White on the right makes a
// narrow picture as wide as the scale. Depths beyond depth_range() have the colours of its ends; 0 (unknown)
// is light grey.
std::vector<std::uint8_t> encode_depth_color_png(int width, int height,
                                                 const std::vector<std::uint16_t>& millimetres);

// Draws a chart of source_lines() for 1, 3, .. 31 lines, but no more than the height of the tables. It has
// two curves for each table: the largest number and the mean.
std::vector<std::uint8_t> encode_source_lines_png(const kernels::RectificationTable& left,
                                                  const kernels::RectificationTable& right);

}  // namespace stereotlm::calib
