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

// How well a rig explains the pairs that were left out when it was fitted to the others, each pair once.
struct HeldOut {
  double rms_px = 0;   // reprojection, over the pictures of both cameras
  RowError row_error;  // of rectified corners
};

struct Quality {
  double left_rms_px = 0;  // reprojection
  double right_rms_px = 0;
  double stereo_rms_px = 0;  // over the pictures of both cameras
  RowError row_error;        // of rectified corners
  RowError
      found_again;  // of corners found in the rectified pictures themselves, nearest pixel as in the tables
  std::optional<HeldOut> held_out;  // nothing if there are too few pairs
  DisparityRange disparities;       // of the grid, whole and true
};

// A pair of pictures in which the grid was found.
struct Source {
  std::string left;  // files
  std::string right;
  std::size_t corners_used = 0;
};

// What the file of a calibration holds.
struct Calibration {
  GridShape grid;
  Rig rig;
  Rectification rectification;
  int disparities = 0;  // that it was made for
  int disparity_offset = 0;
  Quality quality;
  std::vector<Source> sources;
  std::string left_lut_sha256;  // of the files of the tables
  std::string right_lut_sha256;
};

}  // namespace stereotlm::calib
