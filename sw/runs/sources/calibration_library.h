#pragma once

#include "calib/calibrate.h"
#include "calib/drawings.h"

namespace stereotlm::runs {

// The functions of calib that need OpenCV and cairo. They are in a library that is loaded by the first call
// of calibration_functions().
struct CalibrationFunctions {
  // calibrate.h, calibration.h
  decltype(&calib::calibrate) calibrate;
  decltype(&calib::calibration_yaml) calibration_yaml;
  decltype(&calib::matched_rows) matched_rows;
  // drawings.h
  decltype(&calib::encode_corners_png) encode_corners_png;
  decltype(&calib::encode_rectified_pair_png) encode_rectified_pair_png;
  decltype(&calib::encode_displacement_png) encode_displacement_png;
  decltype(&calib::encode_source_lines_png) encode_source_lines_png;
  decltype(&calib::encode_depth_color_png) encode_depth_color_png;
};

// Throws std::runtime_error if the library, which is installed with the program, cannot be loaded.
const CalibrationFunctions& calibration_functions();

}  // namespace stereotlm::runs
