#pragma once

#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "sw/process/problems.h"

namespace stereotlm::cli {

// Loads the pictures that match the patterns, as pairs; both sides are sorted by name. Reports problems: a pattern
// without files, different counts, a file that is no picture, a picture that appears twice, different sizes.
// Prints notes on standard error: pictures that were converted to grey, and pairs whose names differ in more than
// the parts that all names of a side share. Stops when interrupted().
std::vector<calib::PicturePair> load_grid_pictures(const std::vector<std::string>& left,
                                                   const std::vector<std::string>& right,
                                                   process::Problems& problems);

}  // namespace stereotlm::cli
