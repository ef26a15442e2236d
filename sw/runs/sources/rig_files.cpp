#include "sw/runs/sources/rig_files.h"

#include <fmt/format.h>

#include <stdexcept>

namespace stereotlm::runs {

namespace fs = std::filesystem;

RigFiles rig_files(const std::string& calibration) {
  const fs::path path = calibration;
  if (path.extension() != ".yaml") {
    throw std::runtime_error(fmt::format("'{}': the file of a calibration must end in .yaml", calibration));
  }
  const auto beside = [&path](const char* ending) {
    return path.parent_path() / (path.stem().string() + ending);
  };
  return {path, beside("_left.lut"), beside("_right.lut"), beside("_drawings"), beside("_pictures")};
}

}  // namespace stereotlm::runs
