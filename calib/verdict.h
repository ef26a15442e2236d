#pragma once

#include <string>

#include "calib/calibration.h"

namespace stereotlm::calib {

// What a calibration is worth: "good: ..", or "usable: ..", with each weakness and what to do about it. A bad
// one is refused when it is made. Nothing is known of an imported one, which has no pictures.
std::string verdict_of(const Calibration& calibration);

}  // namespace stereotlm::calib
