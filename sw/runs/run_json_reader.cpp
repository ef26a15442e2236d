#include "sw/runs/run_json_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace stereotlm::runs {
namespace {

using Json = nlohmann::ordered_json;

InputFile input_file(const Json& value) { return {value.at("path"), value.at("sha256")}; }

void read(const Json& document, const char* key, std::optional<InputFile>& file) {
  if (document.contains(key)) file = input_file(document[key]);
}

void read(const Json& document, const char* key, bool& value) { value = document.value(key, value); }

void read_sources(const Json& document, RecordedOptions& options) {
  read(document, "left", options.left);
  read(document, "right", options.right);
  if (document.contains("sequence")) {
    const Json& folder = document["sequence"];
    InputFolder& sequence = options.sequence.emplace();
    sequence.path = folder.at("path");
    for (const Json& file : folder.at("files"))
      sequence.files.push_back({file.at("name"), file.at("sha256")});
  }
  if (document.contains("video")) {
    for (const Json& file : document["video"]) options.video.push_back(input_file(file));
    options.video_layout = document.at("video_layout");
  }
  if (document.contains("synthetic")) options.synthetic = document["synthetic"].get<std::uint64_t>();
}

RecordedOptions read_options(const Json& document) {
  RecordedOptions options;
  options.program_version = document.at("version");
  options.source = document.at("source");
  options.fidelity = document.at("fidelity");
  options.frames = document.at("frames");
  read(document, "timing_only", options.timing_only);
  read(document, "verify", options.verify);
  read_sources(document, options);
  if (document.contains("calibration")) {
    const Json& file = document["calibration"];
    options.calibration = {input_file(file), input_file(file.at("left_lut")),
                           input_file(file.at("right_lut"))};
  }
  read(document, "truth", options.truth);
  options.truth_scale = document.value("truth_scale", options.truth_scale);
  read(document, "save_frames", options.save_frames);
  read(document, "record", options.record);
  return options;
}

// The number, from 1, of the first line in which the texts differ.
std::ptrdiff_t first_other_line(const std::string& text, const std::string& other) {
  const auto end = std::mismatch(text.begin(), text.end(), other.begin(), other.end()).first;
  return std::count(text.begin(), end, '\n') + 1;
}

// Throws std::runtime_error for options that run_json() would write but no run can have.
void check(const RecordedOptions& options) {
  const auto require = [](bool holds, const std::string& rule) {
    if (!holds) throw std::runtime_error(rule);
  };
  require(options.source == "camera" || options.source == "preloaded",
          fmt::format("source = {}: must be camera or preloaded", options.source));
  require(options.fidelity == "fast" || options.fidelity == "cycle",
          fmt::format("fidelity = {}: must be fast or cycle", options.fidelity));
  require(options.frames > 0, "frames = 0: must be 1 or more");
  require(options.left.has_value() == options.right.has_value(), "left and right: one is without the other");
  const int sources = int{options.left.has_value()} + int{options.sequence.has_value()} +
                      int{!options.video.empty()} + int{options.synthetic.has_value()};
  require(sources == 1 || (sources == 0 && options.timing_only),
          fmt::format("{} sources of pictures: must be one", sources));
}

}  // namespace

RecordedOptions parse_run_json(const std::string& text) {
  RecordedOptions options;
  std::string written;
  try {
    options = read_options(Json::parse(text));
    written = run_json(options);
  } catch (const Json::exception& error) {
    throw std::runtime_error(fmt::format("must be as run writes it: {}", error.what()));
  }
  if (written != text) {
    throw std::runtime_error(
        fmt::format("line {}: must be as run writes it", first_other_line(text, written)));
  }
  check(options);
  return options;
}

}  // namespace stereotlm::runs
