#pragma once

#include "calib/calibrate.h"
#include "calib/drawings.h"
#include "calib/import_rig.h"

namespace stereotlm::runs {

// The functions of calib that need OpenCV. They are in a library that is loaded by the first call
// of calibration_functions().
struct CalibrationFunctions {
  // calibrate.h, calibration.h
  decltype(&calib::calibrate) calibrate;
  decltype(&calib::calibration_yaml) calibration_yaml;
  decltype(&calib::matched_rows) matched_rows;
  // drawings.h
  decltype(&calib::drawings) drawings;
  decltype(&calib::encode_depth_color_png) encode_depth_color_png;
  // import_rig.h, rig.h
  decltype(&calib::import_rig) import_rig;
  decltype(&calib::foreign_format) foreign_format;
  decltype(&calib::export_rig) export_rig;
  decltype(&calib::rectify) rectify;
};

// Throws std::runtime_error if the library, which is installed with the program, cannot be loaded.
const CalibrationFunctions& calibration_functions();

}  // namespace stereotlm::runs
