#pragma once

#include <string>
#include <vector>

#include "calib/calibrate.h"
#include "sw/files/output_folder.h"
#include "sw/process/problems.h"
#include "sw/runs/sources/calibration_input.h"

namespace stereotlm::cli {

// Loads the pictures of the calibration grid that match the patterns. Sorts both sides by name, and pairs
// them in this order. Reports problems: a pattern without files, different counts, a file that is no picture,
// a picture that appears twice, different sizes. Prints notes on standard error: how many pictures were
// converted to grey, and the first pair whose names differ after the prefix and suffix that all names of a
// side share are removed. Returns early when interrupted().
std::vector<calib::PicturePair> load_grid_pictures(const std::vector<std::string>& left,
                                                   const std::vector<std::string>& right,
                                                   process::Problems& problems);

// The files of `calibrate` in the folder of the calibration F.yaml: its mark F.yaml, the tables, the
// drawings, and the pictures if it `makes_pictures`; otherwise an existing F_pictures/ stays. Other files in
// the folder stay. New files are first written to the folder F.partial beside F.yaml.
files::OutputContent calibration_content(const runs::RigFiles& files, bool makes_pictures,
                                         const std::vector<files::NamedFile>& inputs = {});

}  // namespace stereotlm::cli
