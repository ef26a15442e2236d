#pragma once

#include <string>

#include "calib/calibration.h"

namespace stereotlm::calib {

// Reads the text that calibration_yaml() wrote, to the last bit. Throws std::runtime_error with the line, the
// key, the value and the rule: for text of another kind, a missing key, a matrix of another size, numbers
// that are not finite, a rotation that is none, or a Q that does not follow from P1 and P2.
Calibration parse_calibration(const std::string& text);

}  // namespace stereotlm::calib
