#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stereotlm::runs {

// A file that a run has read.
struct InputFile {
  std::string path;    // absolute, UTF-8
  std::string sha256;  // SHA-256 of its content, 64 hexadecimal digits
};

struct InputCalibration {
  InputFile file;
  InputFile left_lut;
  InputFile right_lut;
};

// The folder of --sequence.
struct InputFolder {
  std::string path;              // absolute, UTF-8
  std::vector<InputFile> files;  // `path` of each: its name in the folder
};

// The pictures of a run. At most one source is there: a pair, a sequence, a video or a synthetic scene.
struct InputPictures {
  std::vector<InputFile> left;   // that of one pair, or those of a sequence of pairs
  std::vector<InputFile> right;  // as many
  std::optional<InputFolder> sequence;
  std::vector<InputFile> video;
  std::string video_layout;                // only with a video
  std::string fit;                         // of --fit, or empty
  std::optional<std::uint64_t> synthetic;  // the seed
};

// The options of a `run`, as run.json records them, without the board, which config.yaml holds in full. A
// `run` with the recorded options and board writes the same bytes again.
struct RecordedOptions : InputPictures {
  std::string program_version;
  std::string source;    // "preloaded"
  std::string fidelity;  // "fast"
  bool timing_only = false;
  bool verify = false;  // also false if the comparison was interrupted
  std::uint64_t frames = 1;
  std::optional<InputCalibration> calibration;
  std::optional<int> disparity_offset;  // only without a calibration
  std::optional<InputFile> truth;
  double truth_scale = 1;  // only with a truth
  bool save_frames = false;
  bool record = false;
  bool no_record = false;
};

// The text of run.json. Keys are the names of the options; an option that was not given is absent. Throws
// std::runtime_error with the option's name if a path is not absolute or not UTF-8.
std::string run_json(const RecordedOptions& options);

// Reads the options of a run from the text of its run.json. Throws std::runtime_error if run_json() would not
// write exactly this text for the options; the message does not name the file.
RecordedOptions parse_run_json(const std::string& text);

}  // namespace stereotlm::runs
