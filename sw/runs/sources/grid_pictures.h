#pragma once

#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "sw/process/problems.h"

namespace stereotlm::runs {

// Loads the pictures of the calibration grid that find_pairs() finds. Reports problems: also a file that is
// no picture, a picture that appears twice, different sizes. Prints its notes, and how many pictures were
// converted to grey. Returns early when interrupted().
std::vector<calib::PicturePair> load_grid_pictures(const std::vector<std::string>& left,
                                                   const std::vector<std::string>& right,
                                                   process::Problems& problems);

}  // namespace stereotlm::runs
