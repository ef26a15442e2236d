#include "sw/runs/run_json.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "sw/files/json_text.h"

namespace stereotlm::runs {
namespace {

using Json = nlohmann::ordered_json;

// Returns the name. Throws std::runtime_error if run.json cannot hold it, because it is not UTF-8.
std::string named(const char* option, const std::string& name) {
  try {
    static_cast<void>(files::json_text(name));
  } catch (const std::invalid_argument&) {
    throw std::runtime_error(
        fmt::format("{} '{}': a path that is not UTF-8: run.json cannot name it", option, name));
  }
  return name;
}

std::string found_again(const char* option, const std::string& path) {
  if (!std::filesystem::path(path).is_absolute()) {
    throw std::runtime_error(fmt::format("{} '{}': not an absolute path: run.json needs one", option, path));
  }
  return named(option, path);
}

Json to_json(const char* option, const InputFile& file) {
  return {{"path", found_again(option, file.path)}, {"sha256", file.sha256}};
}

Json to_json(const char* option, const std::vector<InputFile>& files) {
  Json result = Json::array();
  for (const InputFile& file : files) result.push_back(to_json(option, file));
  return result;
}

Json to_json(const char* option, const InputFolder& folder) {
  Json files = Json::array();
  for (const InputFile& file : folder.files) {
    files.push_back({{"name", named(option, file.path)}, {"sha256", file.sha256}});
  }
  return {{"path", found_again(option, folder.path)}, {"files", files}};
}

Json to_json(const InputCalibration& calibration) {
  const char* option = "--calibration";
  Json result = to_json(option, calibration.file);
  result["left_lut"] = to_json(option, calibration.left_lut);
  result["right_lut"] = to_json(option, calibration.right_lut);
  return result;
}

}  // namespace

std::string run_json(const RecordedOptions& options) {
  Json document = {{"schema", 1},
                   {"command", "run"},
                   {"version", options.program_version},
                   {"source", options.source},
                   {"fidelity", options.fidelity},
                   {"frames", options.frames}};
  if (options.timing_only) document["timing_only"] = true;
  if (options.verify) document["verify"] = true;
  if (options.left) document["left"] = to_json("--left", *options.left);
  if (options.right) document["right"] = to_json("--right", *options.right);
  if (options.sequence) document["sequence"] = to_json("--sequence", *options.sequence);
  if (!options.video.empty()) {
    document["video"] = to_json("--video", options.video);
    document["video_layout"] = options.video_layout;
  }
  if (options.synthetic) document["synthetic"] = *options.synthetic;
  if (options.calibration) document["calibration"] = to_json(*options.calibration);
  if (options.truth) {
    document["truth"] = to_json("--truth", *options.truth);
    document["truth_scale"] = options.truth_scale;
  }
  if (options.save_frames) document["save_frames"] = true;
  if (options.record) document["record"] = true;
  return files::json_text(document);
}

}  // namespace stereotlm::runs
