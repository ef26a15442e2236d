#include "sw/runs/recorded_run.h"

#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/media/load.h"
#include "sw/process/installation.h"
#include "sw/runs/sources/calibration_input.h"
#include "sw/runs/sources/open_source.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;

struct RecordedFile {
  std::string option;
  InputFile file;  // with its full path
};

std::vector<RecordedFile> inputs_of(const RecordedOptions& options) {
  std::vector<RecordedFile> files;
  const auto add = [&files](const char* option, const InputFile& file) { files.push_back({option, file}); };
  if (options.left) add("--left", *options.left);
  if (options.right) add("--right", *options.right);
  if (options.sequence) {
    for (const InputFile& file : options.sequence->files)
      add("--sequence", {(fs::path(options.sequence->path) / file.path).string(), file.sha256});
  }
  for (const InputFile& file : options.video) add("--video", file);
  if (options.calibration) {
    for (const auto& file :
         {options.calibration->file, options.calibration->left_lut, options.calibration->right_lut})
      add("--calibration", file);
  }
  if (options.truth) add("--truth", *options.truth);
  return files;
}

// Throws std::runtime_error if the file differs from the one that the run used.
void check_input(const RecordedFile& input) {
  const std::string sha256 = files::sha256_file(input.file.path);
  if (sha256 == input.file.sha256) return;
  throw std::runtime_error(fmt::format("'{}': SHA-256 {}: must be that of the file of the run, {}",
                                       input.file.path, sha256, input.file.sha256));
}

// Throws std::runtime_error if the video layout is unknown, or does not fit the number of videos.
PictureSource pictures_of(const RecordedOptions& options) {
  PictureSource pictures;
  if (options.left && options.right)
    pictures.pair = PictureSource::Pair{options.left->path, options.right->path};
  if (options.sequence) pictures.sequence = options.sequence->path;
  if (!options.video.empty()) {
    const auto layout = video_layout_of(options.video_layout);
    if (!layout || options.video.size() != (layout == VideoLayout::kTwo ? 2U : 1U)) {
      throw std::runtime_error(fmt::format("video_layout = {}: must be that of {} file{}",
                                           options.video_layout, options.video.size(),
                                           options.video.size() == 1 ? "" : "s"));
    }
    std::vector<std::string> files;
    for (const InputFile& file : options.video) files.push_back(file.path);
    pictures.video = PictureSource::Video{files, *layout};
  }
  pictures.synthetic = options.synthetic;
  return pictures;
}

// Throws std::runtime_error if the folder has another number of pairs than the run used.
void check_sequence(const InputFolder& found, const InputFolder& recorded) {
  if (found.files.size() == recorded.files.size()) return;
  throw std::runtime_error(fmt::format("'{}': {} pairs: must be those of the run, {}", found.path,
                                       found.files.size() / 2, recorded.files.size() / 2));
}

}  // namespace

std::string version_note(const RecordedOptions& options) {
  return fmt::format("it was written by version {}, this is {}", options.program_version, process::kVersion);
}

std::string name_of(const RecordedRun& run) { return fmt::format("{} '{}'", run.argument, run.folder); }

std::optional<RecordedRun> read_recorded_run(const std::string& argument, const std::string& folder,
                                             const std::string& rule, process::Problems& problems) {
  RecordedRun run;
  run.argument = argument;
  run.folder = folder;
  bool is_right = true;
  const auto attempt = [&](const std::string& what, const std::function<void()>& step) {
    is_right &= problems.attempt(what, step);
  };
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (!fs::is_directory(status)) {
    const bool is_missing = status.type() == fs::file_type::not_found;
    const std::string found = is_missing ? "no such folder" : error ? error.message() : "not a folder";
    problems.add(fmt::format("{}'{}': {}", rule, folder, found));
    return std::nullopt;
  }
  const auto read = [&](const char* name, std::string& text, const std::function<void()>& use) {
    const std::string path = (fs::path(folder) / name).string();
    attempt(rule, [&] {
      text = files::read_whole_file(path);
      attempt(fmt::format("'{}': ", path), use);
    });
  };
  read("run.json", run.run_json, [&] {
    run.options = parse_run_json(run.run_json);
    pictures_of(run.options);
  });
  std::string board;
  read("config.yaml", board,
       [&] { run.board = platform::load_board((fs::path(folder) / "config.yaml").string()); });
  read("stats.json", run.stats_json, [] {});
  if (!is_right) return std::nullopt;
  const RecordedOptions& options = run.options;
  attempt((fs::path(folder) / "stats.json").string() + ":", [&] {
    run.statistics = stats::read_stats(run.stats_json, run.board, options.fidelity, options.frames,
                                       options.source == "camera");
  });
  if (!is_right && options.program_version != process::kVersion) problems.add_note(version_note(options));
  return is_right ? std::optional(run) : std::nullopt;
}

std::optional<RecordedRun> load_recorded_run(const std::string& argument, const std::string& folder,
                                             process::Problems& problems) {
  auto run = read_recorded_run(argument, folder,
                               argument + " must be a folder that run --out has written: ", problems);
  if (!run) return std::nullopt;
  bool is_right = true;
  for (const RecordedFile& input : inputs_of(run->options)) {
    is_right &= problems.attempt(fmt::format("{}: {} ", name_of(*run), input.option),
                                 [&input] { check_input(input); });
  }
  return is_right ? run : std::nullopt;
}

RunInput open_again(const RecordedRun& run, process::Problems& problems) {
  process::Problems found;
  RunInput input;
  input.board = run.board;
  input.described = run.options;
  input.camera = run.options.source == "camera";
  input.fast = run.options.fidelity == "fast";
  input.timing_only = run.options.timing_only;
  input.frames = run.options.frames;
  for (const RecordedFile& each : inputs_of(run.options))
    input.inputs.push_back({each.option, each.file.path});
  RecordedOptions described;
  input.pairs = open_source(pictures_of(run.options), &run.board, described, found).pairs;
  if (described.sequence)
    found.attempt("--sequence ", [&] { check_sequence(*described.sequence, *run.options.sequence); });
  std::optional<CalibrationInput> calibration;
  if (run.options.calibration)
    calibration = load_calibration(run.options.calibration->file.path, &run.board, found);
  found.attempt("", [&] { input.tables = tables_of(run.board, calibration); });
  if (run.options.truth)
    input.truth =
        open_truth({"--truth", run.options.truth->path}, run.options.truth_scale, &run.board, found);
  if (!found.empty()) problems.add(fmt::format("{}: {}", name_of(run), found.in_one_line()));
  return input;
}

}  // namespace stereotlm::runs
