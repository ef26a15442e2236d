#pragma once

#include <filesystem>
#include <string>

namespace stereotlm::runs {

// The files that belong to a calibration F.yaml: the tables lie beside it, and what calibrate draws.
struct RigFiles {
  std::filesystem::path calibration;
  std::filesystem::path left_lut;   // F_left.lut
  std::filesystem::path right_lut;  // F_right.lut
  std::filesystem::path drawings;   // F_drawings/
  std::filesystem::path pictures;   // F_pictures/, of a rig that is made up
};

// Throws std::runtime_error if the name does not end in .yaml.
RigFiles rig_files(const std::string& calibration);

}  // namespace stereotlm::runs
