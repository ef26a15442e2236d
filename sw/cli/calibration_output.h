#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sw/files/output_folder.h"
#include "sw/runs/sources/rig_files.h"

namespace stereotlm::cli {

// Writes the files of `calibrate`: the calibration F.yaml, its tables and its pictures. commit() replaces an
// earlier calibration as a whole; until then the earlier files are unchanged. Other files in the folder stay.
// Implemented by an OutputFolder whose mark is F.yaml; new files are first written to the folder F.partial
// beside F.yaml.
class CalibrationOutput {
 public:
  // Checks that the folder of F.yaml is writable. Throws std::runtime_error, and changes nothing, if
  // - the folder does not exist or is not writable,
  // - F.yaml exists and is no calibration,
  // - a file beside F.yaml has a name that `calibrate` uses but was not written by `calibrate`, or
  // - one of the `inputs` would be replaced.
  // `makes_pictures`: also writes F_pictures/; otherwise an existing F_pictures/ stays.
  CalibrationOutput(const std::string& calibration, bool makes_pictures,
                    const std::vector<files::NamedFile>& inputs = {});

  const runs::RigFiles& files() const { return files_; }

  // Adds a file. `file`: one of files(), or a path inside one of their folders. Throws std::runtime_error if
  // it cannot be stored.
  void add(const std::filesystem::path& file, std::string_view bytes);
  void add(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes);

  // Replaces the earlier calibration. If this fails, restores all files and throws std::runtime_error.
  void commit() { folder_.commit(); }

 private:
  runs::RigFiles files_;
  files::OutputFolder folder_;
};

}  // namespace stereotlm::cli
