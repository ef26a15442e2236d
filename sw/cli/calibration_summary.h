#pragma once

#include <string>

#include "calib/calibrate.h"

namespace stereotlm::cli {

// The summary that calibrate prints: pairs and corners, the rig, its errors, and the use of the tables.
// `pictures`: number of pairs that were given to calibrate().
std::string calibration_summary(const calib::CalibrationResult& result, std::size_t pictures);

}  // namespace stereotlm::cli
