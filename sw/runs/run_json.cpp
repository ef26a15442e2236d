#include "sw/runs/run_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "sw/files/text_forms.h"

namespace stereotlm::runs {
namespace {

using Json = nlohmann::ordered_json;

// Returns the name. Throws std::runtime_error if run.json cannot hold it, because it is not UTF-8.
std::string named(const std::string& option, const std::string& name) {
  try {
    static_cast<void>(files::json_text(name));
  } catch (const std::invalid_argument&) {
    throw std::runtime_error(
        fmt::format("{} '{}': a path that is not UTF-8: run.json cannot name it", option, name));
  }
  return name;
}

std::string found_again(const std::string& option, const std::string& path) {
  if (!std::filesystem::path(path).is_absolute()) {
    throw std::runtime_error(fmt::format("{} '{}': not an absolute path: run.json needs one", option, path));
  }
  return named(option, path);
}

// The value of an option as JSON, and back.
template <typename Value>
Json json_of(const std::string& /*option*/, const Value& value) {
  return value;
}
template <typename Value>
void read(const Json& json, Value& value) {
  json.get_to(value);
}

Json json_of(const std::string& option, const InputFile& file) {
  return {{"path", found_again(option, file.path)}, {"sha256", file.sha256}};
}
void read(const Json& json, InputFile& file) { file = {json.at("path"), json.at("sha256")}; }

Json json_of(const std::string& option, const std::vector<InputFile>& files) {
  Json json = Json::array();
  for (const InputFile& file : files) json.push_back(json_of(option, file));
  return json;
}
void read(const Json& json, std::vector<InputFile>& files) {
  for (const Json& file : json) read(file, files.emplace_back());
}

Json json_of(const std::string& option, const InputFolder& folder) {
  Json files = Json::array();
  for (const InputFile& file : folder.files)
    files.push_back({{"name", named(option, file.path)}, {"sha256", file.sha256}});
  return {{"path", found_again(option, folder.path)}, {"files", files}};
}
void read(const Json& json, InputFolder& folder) {
  folder.path = json.at("path");
  for (const Json& file : json.at("files")) folder.files.push_back({file.at("name"), file.at("sha256")});
}

Json json_of(const std::string& option, const InputCalibration& calibration) {
  Json json = json_of(option, calibration.file);
  json["left_lut"] = json_of(option, calibration.left_lut);
  json["right_lut"] = json_of(option, calibration.right_lut);
  return json;
}
void read(const Json& json, InputCalibration& calibration) {
  read(json, calibration.file);
  read(json.at("left_lut"), calibration.left_lut);
  read(json.at("right_lut"), calibration.right_lut);
}

struct Writer {
  template <typename Value>
  void required(const char* key, const Value& value) {
    document[key] = value;
  }
  template <typename Value>
  void given(const char* key, const Value& value, bool is_given) {
    if (is_given) document[key] = json_of(std::string("--") + key, value);
  }
  template <typename Value>
  void given(const char* key, const std::optional<Value>& value) {
    if (value) given(key, *value, true);
  }
  void given(const char* key, bool value) { given(key, value, value); }
  // A picture, or a list of several.
  void side(const char* key, const std::vector<InputFile>& files) {
    if (files.size() == 1) {
      given(key, files.front(), true);
    } else {
      given(key, files, !files.empty());
    }
  }

  Json document = {{"schema", 1}, {"command", "run"}};
};

struct Reader {
  template <typename Value>
  void required(const char* key, Value& value) {
    if (!document.contains(key)) throw std::runtime_error(std::string(key) + ": missing");
    given(key, value);
  }
  template <typename Value>
  void given(const char* key, Value& value, bool /*is_given*/ = true) {
    try {
      if (document.contains(key)) read(document[key], value);
    } catch (const Json::exception& /*error*/) {
      throw std::runtime_error(fmt::format("{} = {}", key, document[key].dump()));
    }
  }
  template <typename Value>
  void given(const char* key, std::optional<Value>& value) {
    if (document.contains(key)) given(key, value.emplace());
  }
  void side(const char* key, std::vector<InputFile>& files) {
    if (document.contains(key) && document[key].is_object()) {
      given(key, files.emplace_back());
    } else {
      given(key, files);
    }
  }

  const Json document;
};

// The keys, in their order. `document`: a Writer or a Reader.
template <typename Document, typename Options>
void each_key(Document& document, Options& options) {
  document.required("version", options.program_version);
  document.required("source", options.source);
  document.required("fidelity", options.fidelity);
  document.required("frames", options.frames);
  document.given("timing_only", options.timing_only);
  document.given("verify", options.verify);
  document.side("left", options.left);
  document.side("right", options.right);
  document.given("sequence", options.sequence);
  document.given("video", options.video, !options.video.empty());
  document.given("video_layout", options.video_layout, !options.video.empty());
  document.given("synthetic", options.synthetic);
  document.given("fit", options.fit, !options.fit.empty());
  document.given("calibration", options.calibration);
  document.given("disparity_offset", options.disparity_offset);
  document.given("truth", options.truth);
  document.given("truth_scale", options.truth_scale, options.truth.has_value());
  document.given("save_frames", options.save_frames);
  document.given("record", options.record);
  document.given("no_record", options.no_record);
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
  require(options.left.size() == options.right.size(), "left and right: must be as many");
  require(!options.disparity_offset || !options.calibration,
          "disparity_offset: does not go with calibration");
  require(options.fit.empty() || options.fit == "crop" || options.fit == "pad",
          fmt::format("fit = {}: must be crop or pad", options.fit));
  const int sources = int{!options.left.empty()} + int{options.sequence.has_value()} +
                      int{!options.video.empty()} + int{options.synthetic.has_value()};
  require(sources == 1 || (sources == 0 && options.timing_only),
          fmt::format("{} sources of pictures: must be one", sources));
}

}  // namespace

std::string run_json(const RecordedOptions& options) {
  Writer writer;
  each_key(writer, options);
  return files::json_text(writer.document);
}

RecordedOptions parse_run_json(const std::string& text) {
  RecordedOptions options;
  try {
    Reader reader{files::parse_json(text)};
    each_key(reader, options);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("must be as run writes it: {}", error.what()));
  }
  const std::string written = run_json(options);
  if (written != text) {
    const auto end = std::mismatch(text.begin(), text.end(), written.begin(), written.end()).first;
    throw std::runtime_error(
        fmt::format("line {}: must be as run writes it", std::count(text.begin(), end, '\n') + 1));
  }
  check(options);
  return options;
}

}  // namespace stereotlm::runs
