#include "sw/runs/recorded_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/binder.h"
#include "platform/config/board_yaml.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/media/load.h"
#include "sw/process/command.h"
#include "sw/process/streams.h"
#include "sw/runs/run_results.h"
#include "sw/runs/sources/calibration_input.h"
#include "sw/runs/sources/open_source.h"
#include "sw/stats/accuracy.h"
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
  for (const InputFile& file : options.left) add("--left", file);
  for (const InputFile& file : options.right) add("--right", file);
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

constexpr char kFrame = 'f';
constexpr char kFigures = 's';

// The message in which the child sends a frame to the parent: kind, number, rows, pixels. Values are copied
// as bytes, because both processes run the same program.
std::string message_of(const Result& result, const fpga::RowProfile& rows) {
  std::string message(1, kFrame);
  const auto put = [&message](const std::uint64_t* from, std::size_t count) {
    message.append(reinterpret_cast<const char*>(from), count * sizeof *from);
  };
  put(&result.number, 1);
  for (const fpga::RowEnd& row : rows) {
    put(&row.cycles, 1);
    put(row.stalls.data(), row.stalls.size());
  }
  const auto& pixels = result.disparity.pixels;
  return message.append(pixels.begin(), pixels.end());
}

Rerun::Frame frame_of(const std::string& message, const RecordedRun& run) {
  Rerun::Frame frame;
  const char* bytes = message.data() + 1;
  const auto take = [&bytes](void* to, std::size_t count) {
    std::memcpy(to, bytes, count);
    bytes += count;
  };
  take(&frame.number, sizeof frame.number);
  frame.rows.resize(static_cast<std::size_t>(run.board.image.height));
  for (fpga::RowEnd& row : frame.rows) {
    row.stalls.resize(platform::core_ports(run.board).core_size());
    take(&row.cycles, sizeof row.cycles);
    take(row.stalls.data(), row.stalls.size() * sizeof row.stalls[0]);
  }
  if (run.options.timing_only) return frame;
  frame.disparity = kernels::GrayImage(run.board.image.width, run.board.image.height);
  take(frame.disparity.pixels.data(), frame.disparity.pixels.size());
  return frame;
}

void run_again(const RecordedRun& run, const process::Child::Tell& tell) {
  process::Problems problems;
  RunInput input = open_again(run, problems);
  if (!problems.empty()) throw std::runtime_error("cannot be run any more: " + problems.in_one_line());
  input.fast = true;
  Binder binder;
  const auto simulation = make_simulation(input.board, input.tables, *input.pairs, input.mode(), binder);
  simulation->core().record_rows();
  std::deque<fpga::RowProfile> rows;  // rows of frames whose results are not delivered yet
  simulation->run([&] {
    for (fpga::RowProfile& frame : simulation->core().take_rows()) rows.push_back(std::move(frame));
    for (const Result& result : simulation->take_results()) {
      tell(message_of(result, rows.front()));
      rows.pop_front();
    }
  });
  tell(kFigures + figures_of(simulation->statistics(), simulation->last(), input));
}

constexpr std::chrono::milliseconds kBetweenPolls{100};

// Which version has written a run, if it is not this one: a part of messages.
std::string version_note(const RecordedOptions& options) {
  return fmt::format("it was written by version {}, this is {}", options.program_version, process::kVersion);
}

}  // namespace

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
    const fs::path kept = fs::absolute(folder) / "pictures";  // of a folder that may have been moved
    const fs::path truth = fs::absolute(folder) / kKeptTruth;
    if (run.options.truth && fs::exists(truth)) run.options.truth->path = truth.string();
    if (run.options.sequence && fs::is_directory(kept)) run.options.sequence->path = kept.string();
    const std::size_t videos = run.options.video.size();
    if (videos == 0 || videos == video_files(run.options.video_layout)) return;
    throw std::runtime_error(fmt::format("video_layout = {}: must be that of {} file{}",
                                         run.options.video_layout, videos, videos == 1 ? "" : "s"));
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
    is_right &= problems.attempt(fmt::format("{}: {} ", name_of(*run), input.option), [&file = input.file] {
      const std::string sha256 = files::sha256_file(file.path);
      if (sha256 == file.sha256) return;
      throw std::runtime_error(fmt::format("'{}': SHA-256 {}: must be that of the file of the run, {}",
                                           file.path, sha256, file.sha256));
    });
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
  auto pictures = static_cast<const InputPictures&>(run.options);
  OpenedSource source = open_source(pictures, &run.board, found);
  input.pairs = std::move(source.pairs);
  const std::size_t pairs = pictures.sequence ? pictures.sequence->files.size() / 2 : 0;
  const std::size_t recorded = pictures.sequence ? run.options.sequence->files.size() / 2 : 0;
  if (input.pairs && pairs != recorded)
    found.add(fmt::format("--sequence '{}': {} pairs: must be those of the run, {}", pictures.sequence->path,
                          pairs, recorded));
  if (input.timing_only) input.pairs = blank_pairs(run.board);
  std::optional<CalibrationInput> calibration;
  if (run.options.calibration)
    calibration = load_calibration(run.options.calibration->file.path, &run.board, found);
  found.attempt("", [&] {
    const int offset = run.options.disparity_offset.value_or(0);
    input.tables = tables_of(run.board, calibration, offset);
    source.truth_offset = truth_offset(run.board, calibration, offset);
  });
  if (run.options.truth)
    input.truth = open_truth({"--truth", run.options.truth->path}, run.options.truth_scale, source,
                             input.frames - 1, found);
  if (!found.empty()) problems.add(fmt::format("{}: {}", name_of(run), found.in_one_line()));
  return input;
}

std::string figures_of(platform::Statistics statistics, const Result& last, const RunInput& input) {
  statistics.fidelity = input.described.fidelity;
  std::optional<stats::Accuracy> accuracy;
  if (input.truth) accuracy = stats::accuracy(last.disparity, *input.truth);
  return stats::stats_json(statistics, accuracy);
}

void check_repeated(const RecordedRun& run, const std::string& stats_json) {
  if (stats_json == run.stats_json) return;
  const auto differences = stats::stats_differences(run.stats_json, stats_json, "recorded", "again");
  std::string text = "repeated, it has other figures: " + differences.front();
  if (differences.size() > 1) text += fmt::format(", and {} more", differences.size() - 1);
  if (run.options.program_version != process::kVersion) text += "; " + version_note(run.options);
  throw std::runtime_error(text);
}

Rerun::Rerun(const RecordedRun& run)
    : run_(run), child_([&run](const process::Child::Tell& tell) { run_again(run, tell); }) {}

std::optional<Rerun::Frame> Rerun::next() {
  try {
    const std::optional<std::string> message = child_.next();
    if (!message) throw std::runtime_error("has ended without figures");
    if (message->front() == kFrame) return frame_of(*message, run_);
    check_repeated(run_, message->substr(1));
    return std::nullopt;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", name_of(run_), error.what()));
  }
}

DiffLimits::DiffLimits(const RecordedRun& a, const RecordedRun& b) {
  const platform::ImageConfig& size_a = a.board.image;
  const platform::ImageConfig& size_b = b.board.image;
  if (size_a.width != size_b.width || size_a.height != size_b.height) {
    rows = pixels = fmt::format("images of {}x{} in A, of {}x{} in B", size_a.width, size_a.height,
                                size_b.width, size_b.height);
  } else if (a.options.timing_only || b.options.timing_only) {
    const bool both = a.options.timing_only && b.options.timing_only;
    pixels = fmt::format("there are none in {}", both ? "both" : a.options.timing_only ? "A" : "B");
  }
}

FrameAlignment::FrameAlignment(const RecordedRun& a, const RecordedRun& b, const DiffLimits& limits,
                               stats::RowsCsv* csv)
    : limits_(limits), csv_(csv), frames_(std::max(a.options.frames, b.options.frames)), a_(a), b_(b) {}

bool FrameAlignment::run() {
  bool goes_on = read(a_) && read(b_);
  // Advances the run with the lower camera frame, or both runs if these are equal, so that neither run passes
  // a frame that the other one still needs.
  while (goes_on && (a_.ahead || b_.ahead)) {
    const bool takes_a = a_.ahead && (!b_.ahead || a_.ahead->number <= b_.ahead->number);
    const bool takes_b = b_.ahead && (!a_.ahead || b_.ahead->number <= a_.ahead->number);
    if (takes_a && takes_b && limits_.pixels.empty()) {
      pixels_.add(a_.ahead->number, a_.ahead->disparity, b_.ahead->disparity);
      last_common_ = {a_.ahead->number, std::move(a_.ahead->disparity), std::move(b_.ahead->disparity)};
    }
    goes_on = (!takes_a || advance(a_, b_)) && (!takes_b || advance(b_, a_));
    for (; !a_.rows.empty() && !b_.rows.empty(); a_.rows.pop_front(), b_.rows.pop_front()) {
      rows_.add(a_.rows.front(), b_.rows.front());
      if (csv_ != nullptr) csv_->add(a_.rows.front(), b_.rows.front());
    }
  }
  progress_.erase();
  return goes_on;
}

// Reads the next frame of a run. Polls for interrupts while it waits, and returns false after one.
bool FrameAlignment::read(AlignedRun& side) {
  do {
    if (process::interrupted()) return false;
    progress_.show(rows_.frames(), frames_, [this](double seconds) {
      return progress_text(rows_.frames(), frames_, "frames compared", seconds);
    });
  } while (!side.rerun.has_news(kBetweenPolls));
  side.ahead = side.rerun.next();
  return true;
}

bool FrameAlignment::advance(AlignedRun& side, const AlignedRun& other) {
  const bool has_partner = other.ahead || !other.rows.empty();
  if (limits_.rows.empty() && has_partner) side.rows.push_back(std::move(side.ahead->rows));
  return read(side);
}

}  // namespace stereotlm::runs
