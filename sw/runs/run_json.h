#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stereotlm::runs {

struct InputFile {
  std::string path;    // absolute, UTF-8
  std::string sha256;  // of its content, 64 hexadecimal digits (sha256.h)
};

struct InputCalibration {
  InputFile file;
  InputFile left_lut;
  InputFile right_lut;
};

struct InputFolder {
  std::string path;              // absolute, UTF-8
  std::vector<InputFile> files;  // their paths are names in the folder
};

// All that `run` was told apart from the board, which config.yaml holds in full. With both, running again
// gives the same bytes.
struct RecordedOptions {
  std::string program_version;
  std::string source;    // "preloaded"
  std::string fidelity;  // "fast"
  bool timing_only = false;
  bool verify = false;  // false too where the comparison was interrupted
  std::uint64_t frames = 1;
  std::optional<InputFile> left;
  std::optional<InputFile> right;
  std::optional<InputFolder> sequence;
  std::vector<InputFile> video;
  std::string video_layout;  // written if there is a video
  std::optional<std::uint64_t> synthetic;
  std::optional<InputCalibration> calibration;
  std::optional<InputFile> truth;
  double truth_scale = 1;  // written if there is a truth
  bool save_frames = false;
};

// The text of run.json: keys are the names of the options, one not given is absent. Throws std::runtime_error
// naming the option whose path is not absolute or not UTF-8.
std::string run_json(const RecordedOptions& options);

}  // namespace stereotlm::runs
