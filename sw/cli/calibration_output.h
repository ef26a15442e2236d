#pragma once

#include <vector>

#include "sw/files/output_folder.h"
#include "sw/runs/sources/rig_files.h"

namespace stereotlm::cli {

// The files of `calibrate` in the folder of the calibration F.yaml: its mark F.yaml, the tables, the drawings,
// and the pictures if it `makes_pictures`; otherwise an existing F_pictures/ stays. Other files in the folder
// stay. New files are first written to the folder F.partial beside F.yaml.
files::OutputContent calibration_content(const runs::RigFiles& files, bool makes_pictures,
                                         const std::vector<files::NamedFile>& inputs = {});

}  // namespace stereotlm::cli
