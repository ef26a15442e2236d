#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "calib/drawings.h"
#include "calib/grid_sheet.h"

namespace stereotlm::runs {

// The functions of calib that need OpenCV and cairo. They are in a library that is loaded by the first call
// of calibration_functions().
struct CalibrationFunctions {
  // calibrate.h, calibration.h
  calib::CalibrationResult (*calibrate)(const calib::CalibrationRequest& request);
  std::string (*calibration_yaml)(const calib::Calibration& calibration);
  calib::MatchedRows (*matched_rows)(const kernels::GrayImage& left, const kernels::GrayImage& right,
                                     int disparities);
  // drawings.h
  std::vector<std::uint8_t> (*encode_corners_png)(const calib::GridShape& shape,
                                                  const calib::CaptionedImage& left,
                                                  const calib::MarkedCorners& left_corners,
                                                  const calib::CaptionedImage& right,
                                                  const calib::MarkedCorners& right_corners);
  std::vector<std::uint8_t> (*encode_rectified_pair_png)(const calib::CaptionedImage& left,
                                                         const calib::CaptionedImage& right);
  std::vector<std::uint8_t> (*encode_displacement_png)(const kernels::RectificationTable& left,
                                                       const kernels::RectificationTable& right);
  std::vector<std::uint8_t> (*encode_source_lines_png)(const kernels::RectificationTable& left,
                                                       const kernels::RectificationTable& right);
  std::vector<std::uint8_t> (*encode_depth_color_png)(int width, int height,
                                                      const std::vector<std::uint16_t>& millimetres);
  // grid_sheet.h
  std::string (*grid_sheet_pdf)(const calib::GridShape& shape);
  std::string (*grid_sheet_svg)(const calib::GridShape& shape);
};

// Throws std::runtime_error if the library, which is installed with the program, cannot be loaded.
const CalibrationFunctions& calibration_functions();

}  // namespace stereotlm::runs
