#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sw/files/output_folder.h"
#include "sw/runs/sources/rig_files.h"

namespace stereotlm::cli {

// The files of calibrate. commit() replaces an earlier calibration F.yaml as a whole; before, it is unchanged.
// Other files in the folder stay. An OutputFolder whose mark is F.yaml; new files are first written to the folder
// F.partial beside F.yaml.
class CalibrationOutput {
 public:
  // Checks that the folder is writable. Changes nothing and throws std::runtime_error if it does not exist or is
  // not writable, if F.yaml exists and is no calibration, or if a file beside it has a name that calibrate uses
  // but was not written by calibrate. `makes_pictures`: writes F_pictures/ too; otherwise that folder stays.
  CalibrationOutput(const std::string& calibration, bool makes_pictures);

  const runs::RigFiles& files() const { return files_; }

  // Adds a file. `file`: one of files(), or one below a folder of files(). Throws std::runtime_error if it cannot
  // be stored.
  void add(const std::filesystem::path& file, std::string_view bytes);
  void add(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes);

  // Replaces the earlier calibration. If it fails, restores all files and throws std::runtime_error.
  void commit() { folder_.commit(); }

 private:
  runs::RigFiles files_;
  files::OutputFolder folder_;
};

}  // namespace stereotlm::cli
