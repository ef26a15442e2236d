#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sw/files/output_folder.h"

namespace stereotlm::runs {

// The file name of a frame's disparities in a result folder: "frames/000000.png".
std::string frame_file_name(std::uint64_t frame);

// The folder of `run --out`, which holds one result and nothing else. Its mark is run.json. `inputs`: see
// OutputContent.
files::OutputContent result_content(std::vector<files::NamedFile> inputs = {});

}  // namespace stereotlm::runs
