#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "calib/calibrate.h"

// Drawings for a person who calibrates a rig, as PNG bytes. The same input gives the same bytes.
namespace stereotlm::calib {

// The drawings of a calibration, by the names of their files. The left half of each belongs to the left
// camera. NN is the number of a pair of pictures; only pairs with a grid have drawings.
//
// corners_NN.png: the corners found, as OpenCV draws them, with a square around the first. Corners that are
// left out have red crosses.
// rectified_NN.png: the rectified pictures with lines along every 32nd row. Objects lie in the same row on
// both sides.
// displacement.png: the displacement from each entry of the tables to its source, less the mean of its table,
// which the caption gives. Colours (Viridis) show the length, from 0 to the largest of both tables; light
// grey: the entry is not valid. Arrows show the direction. No arrow reaches the next.
std::map<std::string, std::vector<std::uint8_t>> drawings(const CalibrationRequest& request,
                                                          const CalibrationResult& result);

// Draws depths in colours (Viridis), near ones bright, with the scale below. White on the right makes a
// narrow picture as wide as the scale. Depths beyond depth_range() have the colours of its ends; 0 (unknown)
// is light grey.
std::vector<std::uint8_t> encode_depth_color_png(int width, int height,
                                                 const std::vector<std::uint16_t>& millimetres);

}  // namespace stereotlm::calib
