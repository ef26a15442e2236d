#pragma once

#include <string>

#include "calib/calibration.h"

namespace stereotlm::calib {

// Reads a text that calibration_yaml() wrote; every number is the same to the last bit. Throws
// std::runtime_error, which names the line, the key, the value and the rule, for a text of another kind, a
// missing key, a matrix of another size, a number that is not finite, an R that is no rotation, or a Q that
// does not follow from P1 and P2.
Calibration parse_calibration(const std::string& text);

}  // namespace stereotlm::calib
