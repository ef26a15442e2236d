#pragma once

#include <cstddef>
#include <string>

#include "calib/calibration.h"

namespace stereotlm::calib {

// The largest text that parse_calibration() accepts. Each pair of pictures of a calibration adds 60 bytes and
// two paths.
inline constexpr std::size_t kMostCalibrationBytes = 1'000'000;

// Reads a text that calibration_yaml() wrote; every number is the same to the last bit. Throws
// std::runtime_error, which names the line, the key, the value and the rule, for a text of another kind, a
// missing key, a matrix of another size, a number that is not finite, an R that is no rotation, or a Q that
// does not follow from P1 and P2.
Calibration parse_calibration(const std::string& text);

}  // namespace stereotlm::calib
