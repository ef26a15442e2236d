#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sw/files/output_folder.h"
#include "sw/runs/sources/rig_files.h"

namespace stereotlm::cli {

// What calibrate writes: an earlier calibration of that name, or none, until commit(), and the new one whole
// after it. An OutputFolder whose mark is F.yaml; what else is in its folder stays. New files are written
// aside, into the folder F.partial beside F.yaml.
class CalibrationOutput {
 public:
  // Proves that the folder can be written to. Throws std::runtime_error, having changed nothing, if it
  // cannot, or is not there, if F.yaml is there and no calibration, or what lies beside it under the names
  // that calibrate uses was not written by it. `makes_pictures`: F_pictures/ is written too; else nothing
  // touches it.
  CalibrationOutput(const std::string& calibration, bool makes_pictures);

  const runs::RigFiles& files() const { return files_; }

  // `file`: one of files(), or one in a folder of theirs. Throws std::runtime_error if it cannot be stored.
  void add(const std::filesystem::path& file, std::string_view bytes);
  void add(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes);

  // Replaces the earlier calibration. Throws std::runtime_error if that fails, with all back in place.
  void commit() { folder_.commit(); }

 private:
  runs::RigFiles files_;
  files::OutputFolder folder_;
};

}  // namespace stereotlm::cli
