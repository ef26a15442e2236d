#pragma once

#include <string>

#include "calib/calibration.h"

namespace stereotlm::calib {

// The text of a calibration file: OpenCV FileStorage YAML with the keys of OpenCV's stereo_calib sample (M1
// D1 M2 D2 R T R1 R2 P1 P2 Q; lengths in mm), image_width, image_height, disparity_offset, the checksums of
// the tables, the sources and the quality. Throws std::runtime_error if it would be longer than
// parse_calibration() accepts.
std::string calibration_yaml(const Calibration& calibration);

}  // namespace stereotlm::calib
