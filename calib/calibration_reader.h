#pragma once

#include <string>

#include "calib/calibration.h"

namespace stereotlm::calib {

// Reads what calibration_yaml() wrote, to the last bit. Throws std::runtime_error that names the line, the
// key, what was found and the rule: text that is no such file, a missing key, a matrix of another size,
// numbers that are not finite, rotations that are none, a Q that does not follow from P1 and P2.
Calibration parse_calibration(const std::string& text);

}  // namespace stereotlm::calib
