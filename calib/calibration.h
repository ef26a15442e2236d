#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calib/grid_in_view.h"
#include "calib/grid_shape.h"
#include "calib/rectification.h"
#include "calib/rig.h"

namespace stereotlm::calib {

// The errors of pairs under a rig that was fitted without them (cross-validation). Each pair is left out
// once.
struct HeldOut {
  double rms_px = 0;   // reprojection, over the pictures of both cameras
  RowError row_error;  // of rectified corners
};

// How well the calibration explains the corners, in pixels.
struct Quality {
  double left_rms_px = 0;  // reprojection
  double right_rms_px = 0;
  double stereo_rms_px = 0;  // over the pictures of both cameras
  RowError row_error;        // of rectified corners
  // Of corners that are searched again in the rectified pictures. The tables round the sources of their
  // pixels.
  RowError found_again;
  std::optional<HeldOut> held_out;  // nullopt if there are too few pairs
  DisparityRange disparities;       // of the grid, without the offset
};

// A pair of pictures in which the grid was found.
struct Source {
  std::string left;  // files
  std::string right;
  std::size_t corners_used = 0;
};

// The contents of a calibration file.
struct Calibration {
  GridShape grid;
  Rig rig;
  Rectification rectification;
  int disparities = 0;  // number of candidates of the board for which it was made
  int disparity_offset = 0;
  Quality quality;
  std::vector<Source> sources;
  std::string left_lut_sha256;  // of the table files
  std::string right_lut_sha256;
};

}  // namespace stereotlm::calib
