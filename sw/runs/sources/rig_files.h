#pragma once

#include <filesystem>
#include <string>

namespace stereotlm::runs {

// Paths of the files of a calibration F.yaml. All lie beside it.
struct RigFiles {
  std::filesystem::path calibration;
  std::filesystem::path left_lut;   // F_left.lut
  std::filesystem::path right_lut;  // F_right.lut
  std::filesystem::path drawings;   // F_drawings/
  std::filesystem::path pictures;   // F_pictures/, only for a synthetic rig
};

// Throws std::runtime_error if the name does not end in .yaml.
RigFiles rig_files(const std::string& calibration);

}  // namespace stereotlm::runs
