#pragma once

#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "sw/process/problems.h"

namespace stereotlm::runs {

// Loads the pictures of the calibration grid that find_pairs() finds for `left` and `right`, or the halves of
// the files that match `side_by_side`, if it has patterns. Reports problems: also a file that is no picture,
// a picture that appears twice, different sizes. Prints notes: those on the files, and how many pictures were
// converted to grey. Returns early when interrupted().
std::vector<calib::PicturePair> load_grid_pictures(const std::vector<std::string>& left,
                                                   const std::vector<std::string>& right,
                                                   const std::vector<std::string>& side_by_side,
                                                   process::Problems& problems);

// Loads up to 40 pairs of a video, evenly spread over its frames. `files` and `layout`: as of InputPictures.
// Reports problems as the function above.
std::vector<calib::PicturePair> load_grid_video(const std::vector<std::string>& files,
                                                const std::string& layout, process::Problems& problems);

}  // namespace stereotlm::runs
