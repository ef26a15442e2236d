#pragma once

#include <string>

#include "calib/calibration.h"
#include "models/kernels/rectification_table.h"

// The parts of what `calibrate` prints.
namespace stereotlm::cli {

// A line with its name.
std::string calibration_row(const std::string& name, const std::string& text);

// The rows of cameras, certainty, quality and disparities.
std::string calibration_text(const calib::Calibration& made);

// How many entries of a table are empty.
std::string entries_text(const kernels::RectificationTable& table);

}  // namespace stereotlm::cli
