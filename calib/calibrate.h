#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/calibration.h"
#include "calib/rig_fit.h"
#include "calib/tables.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

struct PicturePair {
  std::string left_name;
  std::string right_name;
  kernels::GrayImage left;
  kernels::GrayImage right;
};

struct CalibrationRequest {
  GridShape grid;
  std::vector<PicturePair> pictures;    // all of one size
  int disparities = 80;                 // candidates of the board
  std::optional<int> disparity_offset;  // nothing: chosen so that the grid's disparities fit
};

// A pair in which the grid was found.
struct CalibratedPair {
  std::size_t picture = 0;  // of the request
  GridPair corners;
  std::vector<bool> used;  // by corner: it fits
};

struct CalibrationResult {
  Calibration calibration;  // without the sums of the tables
  TablePair tables;
  std::vector<CalibratedPair> pairs;
  std::vector<LeftOutCorner> left_out;  // their pair: of `pairs`
  Lens lens = Lens::kFull;              // without k3 if the grid was not seen where that shows
  std::vector<std::string> skipped;     // pictures without grid: "'left04.jpg': no grid of .."
};

// From pictures of a grid to the tables: finds the corners, fits the rig to those that fit one, rectifies,
// chooses the disparity offset, and measures how good all that is. Throws std::invalid_argument, with all
// that is needed to mend it: too few pairs with a grid; cameras swapped or one above the other; disparities
// that do not hold the grid's.
CalibrationResult calibrate(const CalibrationRequest& request);

}  // namespace stereotlm::calib
