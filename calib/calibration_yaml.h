#pragma once

#include <string>

#include "calib/calibration.h"

namespace stereotlm::calib {

// The file of a calibration: OpenCV FileStorage YAML with the keys of OpenCV's stereo_calib sample (M1 D1 M2
// D2 R T R1 R2 P1 P2 Q; lengths in mm), image_width, image_height, disparity_offset, the sums of the tables,
// where it comes from and how good it is.
std::string calibration_yaml(const Calibration& calibration);

// Reads what calibration_yaml() wrote, to the last bit. Throws std::runtime_error that names the key, its
// value and the rule: text that is no such file, a missing key, a matrix of another size, numbers that are
// not finite, rotations that are none, a Q that does not follow from P1 and P2.
Calibration parse_calibration(const std::string& text);

}  // namespace stereotlm::calib
