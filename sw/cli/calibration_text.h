#pragma once

#include <string>

#include "calib/calibration.h"
#include "models/kernels/rectification_table.h"

// The parts of what `calibrate` prints.
namespace stereotlm::cli {

// A line with its name.
std::string calibration_row(const std::string& name, const std::string& text);

std::string camera_text(const calib::CameraModel& camera);
// The nearest and the farthest depth that the disparities cover.
std::string depths_text(const calib::Calibration& made);
// The disparities of the rectified pictures that those of the board are.
std::string offset_text(const calib::Calibration& made);
std::string entries_text(const kernels::RectificationTable& table);

}  // namespace stereotlm::cli
