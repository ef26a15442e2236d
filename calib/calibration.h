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

// How well a rig that was fitted to some pairs explains the pairs that were left out. Each pair is left out
// once.
struct HeldOut {
  double rms_px = 0;   // reprojection, over the pictures of both cameras
  RowError row_error;  // of rectified corners
};

struct Quality {
  double left_rms_px = 0;  // reprojection
  double right_rms_px = 0;
  double stereo_rms_px = 0;  // over the pictures of both cameras
  RowError row_error;        // of rectified corners
  RowError found_again;  // of corners found in the rectified pictures, whose pixels are rounded by the tables
  std::optional<HeldOut> held_out;  // nothing if there are too few pairs
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
  int disparities = 0;  // number of candidates for which it was made
  int disparity_offset = 0;
  Quality quality;
  std::vector<Source> sources;
  std::string left_lut_sha256;  // of the table files
  std::string right_lut_sha256;
};

}  // namespace stereotlm::calib
