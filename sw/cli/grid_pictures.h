#pragma once

#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "sw/process/problems.h"

namespace stereotlm::cli {

// The pictures that the patterns name, in pairs: both sides in the order of their names. Reports what is
// wrong: a pattern without files, counts that differ, what is no picture, a picture that is there twice,
// pictures of different sizes. Says on standard error which pictures were converted to grey, and where the
// names of a pair differ in more than what all of their side have in common. Ends where it is interrupted().
std::vector<calib::PicturePair> load_grid_pictures(const std::vector<std::string>& left,
                                                   const std::vector<std::string>& right,
                                                   process::Problems& problems);

}  // namespace stereotlm::cli
