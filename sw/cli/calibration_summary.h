#pragma once

#include <string>

#include "calib/calibrate.h"

namespace stereotlm::cli {

// What calibrate prints: how many pairs and corners, the rig, how good it is, what the tables are for.
// `pictures`: pairs that there were.
std::string calibration_summary(const calib::CalibrationResult& result, std::size_t pictures);

}  // namespace stereotlm::cli
