#pragma once

#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "sw/process/problems.h"

namespace stereotlm::runs {

// Loads the pictures of the calibration grid that match the patterns. A file whose name equals a pattern is
// taken literally. Sorts both sides by name, and pairs them in this order. Reports problems: a pattern
// without files, different counts, a file that is no picture, a picture that appears twice, different sizes.
// Prints notes: how many pictures were converted to grey, and the first pair whose names end in different
// numbers. Returns early when interrupted().
std::vector<calib::PicturePair> load_grid_pictures(const std::vector<std::string>& left,
                                                   const std::vector<std::string>& right,
                                                   process::Problems& problems);

}  // namespace stereotlm::runs
