#include "sw/cli/run_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <regex>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "calib/calibration.h"
#include "calib/tables.h"
#include "platform/config/board_area.h"
#include "platform/config/board_draft.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/files/text_forms.h"
#include "sw/process/command.h"
#include "sw/process/streams.h"
#include "sw/runs/pair_check.h"
#include "sw/runs/run_json.h"
#include "sw/runs/run_results.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWindowForms =
    "frame=F, frame=F,rows=A..B, frame=F,cycles=A..B or cycles=A..B, with integers and A not above B; each "
    "may "
    "end with ,longest-wait";

// nullopt if the text has none of the forms.
std::optional<trace::TraceWindow> window_of(const std::string& text) {
  static const std::regex form(
      R"((?:frame=(\d+)(?:,(rows|cycles)=(\d+)\.\.(\d+))?|cycles=(\d+)\.\.(\d+))(,longest-wait)?)");
  std::smatch match;
  if (!std::regex_match(text, match, form)) return std::nullopt;
  trace::TraceWindow found;
  fpga::CycleWindow& window = found.cycles;
  found.around_longest_wait = match[7].matched;
  if (match[2] == "rows") window.unit = fpga::CycleWindow::Unit::kRows;
  if (match[1].matched && !(window.frame = number_of<std::uint64_t>(match[1].str()))) return std::nullopt;
  const std::size_t range = match[3].matched ? 3 : 5;
  if (!match[range].matched) return found;
  const auto first = number_of<std::uint64_t>(match[range].str());
  const auto last = number_of<std::uint64_t>(match[range + 1].str());
  if (!first || !last || *first > *last) return std::nullopt;
  window.first = *first;
  window.last = *last;
  return found;
}

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const trace::TraceFormat& format : trace::kTraceFormats) names.emplace_back(format.name);
  return names;
}

// nullopt if the text is not FORMAT:FILE.
std::optional<trace::TraceFile> file_of(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto* const format =
      std::find_if(std::begin(trace::kTraceFormats), std::end(trace::kTraceFormats),
                   [&](const trace::TraceFormat& each) { return each.name == text.substr(0, colon); });
  if (colon == std::string::npos || format == std::end(trace::kTraceFormats) || colon + 1 == text.size())
    return std::nullopt;
  return trace::TraceFile{format, text.substr(colon + 1)};
}

constexpr const char* kPictureOptions =
    "--left F --right F, --sequence DIR, --video F [F2] or --synthetic SEED";

// Whether `inner` is the folder or lies below it, with links and dots resolved. False if one does not exist.
bool lies_in(const fs::path& inner, const fs::path& folder) {
  std::error_code no_inner;
  std::error_code no_folder;
  const fs::path inside = fs::canonical(inner, no_inner).lexically_relative(fs::canonical(folder, no_folder));
  return !no_inner && !no_folder && *inside.begin() != "..";
}

// `frame`: the last one.
void load_truth(const RunOptions& options, std::uint64_t frame, runs::OpenedSource& source,
                runs::RunInput& input, process::Problems& problems) {
  if (!options.truth.file.is_given()) return;
  const runs::NamedFile file = {"--truth", options.truth.file.text()};
  if (const auto sent = options.truth.sent.find(runs::kKeptTruth); sent != options.truth.sent.end()) {
    input.truth = runs::open_truth(file, options.truth.scale(), source, frame, problems, &sent->second);
    return;  // the file is named once it is in the result folder
  }
  source.files.push_back(file);
  input.truth = runs::open_truth(file, options.truth.scale(), source, frame, problems);
  if (input.truth)
    problems.attempt("--truth ", [&] {
      input.described.truth = {fs::absolute(file.path).string(), files::sha256_file(file.path)};
    });
  if (options.source.is_camera() && source.pairs && source.pairs->length() != 1)
    problems.add(fmt::format(
        "--truth: cameras drop frames: which of {} pairs the last frame shows is not known before the run: "
        "must be a run with one pair, or with --source preloaded",
        source.pairs->length()));
}

void check_offset(const platform::BoardConfig& board, std::optional<int> offset,
                  process::Problems& problems) {
  if (!offset) return;
  if (!board.allocation.left_lut)
    problems.add(fmt::format(
        "--disparity-offset = {}: allocation.left_lut = none: must be a board with a table of the left side, "
        "which moves the picture, such as the preset fpl2003",
        *offset));
  if (std::abs(*offset) >= board.image.width)
    problems.add(fmt::format(
        "--disparity-offset = {1}: must be less than the columns of the images, {0}, and above -{0}",
        board.image.width, *offset));
}

void open_traces(const RunOptions& options, runs::RunInput& input) {
  const std::vector<trace::TraceFile> files = options.trace.traces();
  if (files.empty()) return;
  for (const trace::TraceFile& file : files) {
    const fs::path folder = trace::outputs_of(file).front().parent_path();
    if (!options.out.is_given() || !lies_in(folder, options.out.text())) continue;
    throw std::runtime_error(fmt::format(
        "'{}': inside the result folder '{}', which is replaced whole: must lie outside the folder of --out",
        file.path, options.out.text()));
  }
  input.trace = std::make_unique<trace::Trace>(files, input.board, options.trace.window());
}

void say_what_is_not_seen(const runs::RunInput& input) {
  for (const auto& [side, table] :
       {std::pair("left", &input.tables.left), std::pair("right", &input.tables.right)}) {
    if (calib::is_mostly_empty(**table))
      process::say("warning",
                   fmt::format("--calibration: {} of {} entries of the {} table are empty: hardly "
                               "anything is seen: was its offset right, and its rig?",
                               calib::entries_without_source(**table), (*table)->entries.size(), side));
  }
  const int made_for = input.calibration->disparities;
  const int has = input.board.matcher.disparities;
  if (has < made_for)
    process::say(
        "note",
        fmt::format(
            "--calibration: was made for {} disparities: the nearest objects exceed the {} of this board",
            made_for, has));
}

// Whether a client has sent pictures.
bool has_arrays() {
  if (process::client == nullptr) return false;
  const bool has_left = process::client->given("left") != nullptr;
  return process::client->given("right") != nullptr || has_left;
}

// Sets what the options say of the run.
void describe(const RunOptions& options, runs::RunInput& input) {
  input.camera = options.source.is_camera();
  input.fast = options.fidelity.text() != "cycle";
  input.timing_only = options.timing_only.is_given();
  input.recorded_frames = options.recorded_frames();
  input.json = options.json.is_given();
  runs::RecordedOptions& run = input.described;
  run.program_version = process::kVersion;
  run.source = input.camera ? "camera" : "preloaded";
  run.fidelity = input.fast ? "fast" : "cycle";
  run.timing_only = input.timing_only;
  run.verify = options.verify.is_given();
  run.frames = input.frames;
  run.truth_scale = options.truth.scale().value_or(1);
  run.disparity_offset = options.offset();
  run.save_frames = options.save_frames.is_given();
  run.record = options.record.is_given();
  run.no_record = options.no_record.is_given();
  // Throws now, instead of after the run, if a path cannot be recorded.
  if (options.out.is_given()) run_json(run);
}

}  // namespace

std::vector<std::string> BoardOptions::words_without_allocation() const {
  constexpr std::string_view kSection = "allocation";
  std::vector<std::string> words = {argument.text()};
  if (calibration.is_given()) words.insert(words.end(), {calibration.name(), calibration.text()});
  for (const std::string& set : sets.texts()) {
    if (set.substr(0, set.find_first_of(".=")) != kSection) words.insert(words.end(), {"--set", set});
  }
  return words;
}

const std::string* sent_content(const process::FileContents& sent, const std::string& name,
                                const std::string& path) {
  if (const auto found = sent.find(name); found != sent.end()) return &found->second;
  std::error_code none;
  const fs::file_type type = fs::status(path, none).type();
  if (process::client != nullptr && (type == fs::file_type::fifo || type == fs::file_type::character))
    throw std::runtime_error(path + ": must be a regular file");
  return nullptr;
}

std::optional<runs::CalibrationInput> calibration_of(explore::Plan& plan, const Option& option,
                                                     const process::FileContents& sent) {
  const std::string path = option.is_given() ? option.text() : plan.calibration();
  if (path.empty()) return std::nullopt;
  const std::string named = option.is_given()
                                ? option.name()
                                : fmt::format("{}: {}", plan.calibration_place(), explore::kCalibrationPath);
  process::Problems problems;
  if (!plan.seeds().empty())
    problems.add(fmt::format("{}: does not go with {}: its tables would move the made scenes", named,
                             explore::kSyntheticPath));
  auto calibration = runs::load_calibration(path, nullptr, problems, named, sent);
  if (calibration) {
    const calib::Rig& rig = calibration->calibration->rig;
    const auto problem = plan.use_calibration(runs::sha256_of(calibration->tables), rig.width, rig.height,
                                              platform::joint_tables_problem(calibration->tables));
    if (problem) problems.add(fmt::format("{} '{}': {}", named, path, *problem));
  }
  problems.check();
  return calibration;
}

LoadedBoard BoardOptions::load(process::Problems& problems) const {
  LoadedBoard loaded;
  problems.attempt("", [&] {
    const std::string path = argument.is_given() ? argument.text() : "fpl2003";
    platform::BoardDraft draft(path,
                               sent_content(sent, "board.yaml", platform::is_board_file(path) ? path : ""));
    for (const std::string& set : sets.texts()) draft.set(set);
    loaded.board = draft.read();
    loaded.file_text = draft.file_text();
  });
  if (calibration.is_given()) {
    loaded.calibration = runs::load_calibration(calibration.text(), loaded.board ? &*loaded.board : nullptr,
                                                problems, calibration.name(), sent);
  }
  return loaded;
}

void LoadedBoard::say_clock_remark() const {
  const std::string remark = platform::clock_remark(*board);
  if (!remark.empty()) process::say("note", remark);
}

void check_jobs(std::uint64_t jobs, std::uint64_t workers) {
  const std::uint64_t most = explore::workers_with_files(workers);
  if (most >= workers) return;
  process::refuse(
      fmt::format("--jobs = {}: too many for the limit on open files (ulimit -n): {}", jobs,
                  most == 0 ? "raise it" : fmt::format("lower --jobs to {}, or raise the limit", most)));
}

std::string most_banks_text(int asked, std::size_t banks) {
  return fmt::format(
      "--banks = {}: must be 1..{}, the banks of the board; --set 'ssram.banks.NEW={{}}' gives it one more",
      asked, banks);
}

std::string TraceOptions::meaning() {
  return fmt::format(
      "Write a trace of the run; FORMAT is {}; repeat it for more traces; a vcd whose FILE ends in .fst "
      "becomes FST",
      fmt::join(format_names(), ", "));
}

void TraceOptions::is_window(const Option& option, process::Problems& problems) {
  if (option.is_given() && !window_of(option.text()))
    problems.add(fmt::format("--trace-window = '{}': must be {}", option.text(), kWindowForms));
}

void TraceOptions::check_together(process::Problems& problems) const {
  std::set<std::filesystem::path> outputs;
  for (const std::string& text : files.texts()) {
    const auto file = file_of(text);
    if (!file) {
      problems.add(fmt::format("--trace '{}': must be FORMAT:FILE, where FORMAT is {}", text,
                               platform::listed(format_names())));
      continue;
    }
    try {
      const auto own = trace::outputs_of(*file);
      const auto shared =
          std::find_if(own.begin(), own.end(),
                       [&outputs](const std::filesystem::path& output) { return outputs.count(output) > 0; });
      if (shared != own.end())
        problems.add(fmt::format("--trace '{}': '{}' is the file of two traces: each needs its own", text,
                                 shared->string()));
      outputs.insert(own.begin(), own.end());
    } catch (const std::system_error&) {  // trace::Trace says why
    }
    if (file->format->needs_window && !window_text.is_given())
      problems.add(fmt::format("--trace '{}': needs --trace-window: a {} has only the cycles of a window",
                               text, file->format->name));
  }
}

void TraceOptions::check_window(const platform::BoardConfig& board, std::uint64_t frames,
                                process::Problems& problems) const {
  const auto traced = window();
  if (!traced) return;
  const fpga::CycleWindow& cycles = traced->cycles;
  if (cycles.frame && *cycles.frame >= frames) {
    problems.add(fmt::format("--trace-window = '{}': frame {}: must be below the frames of the run, {}",
                             window_text.text(), *cycles.frame, frames));
  }
  const auto height = static_cast<std::uint64_t>(board.image.height);
  if (cycles.unit == fpga::CycleWindow::Unit::kRows && cycles.last >= height) {
    problems.add(fmt::format("--trace-window = '{}': row {}: must be below the rows of the image, {}",
                             window_text.text(), cycles.last, height));
  }
}

std::vector<trace::TraceFile> TraceOptions::traces() const {
  std::vector<trace::TraceFile> found;
  for (const std::string& text : files.texts()) {
    if (auto file = file_of(text)) found.push_back(std::move(*file));
  }
  return found;
}

std::optional<trace::TraceWindow> TraceOptions::window() const { return window_of(window_text.text()); }

bool PictureOptions::check_together(process::Problems& problems, bool may_be_missing) const {
  const std::vector<std::string> given = sources_given();
  bool is_missing = given.empty() && !may_be_missing;
  if (is_missing) problems.add(fmt::format("pictures: missing: a run needs {}", kPictureOptions));
  if (left.is_given() != right.is_given()) {
    is_missing = true;
    problems.add(left.is_given() ? "--right: missing: goes with --left F"
                                 : "--left: missing: goes with --right F");
  }
  if (given.size() > 1)
    problems.add(
        fmt::format("{}: a run has one source of pictures: {}", fmt::join(given, ", "), kPictureOptions));
  check_video(video, video_layout, problems);
  return !is_missing;
}

void check_video(const Option& video, const Option& layout, process::Problems& problems) {
  if (video.is_given() && !layout.is_given())
    problems.add(fmt::format("--video-layout: missing: goes with --video, one of {}",
                             platform::listed(runs::kVideoLayoutNames)));
  const std::size_t needed = runs::video_files(layout.text());
  if (video.is_given() && needed > 0 && video.texts().size() != needed)
    problems.add(fmt::format("--video '{}': must name {} with --video-layout {}",
                             fmt::join(video.texts(), "' '"), needed == 1 ? "one file" : "two files",
                             layout.text()));
}

std::vector<std::string> PictureOptions::sources_given() const {
  std::vector<std::string> names;
  if (has_arrays()) names.emplace_back("arrays");
  if (left.is_given() || right.is_given()) names.push_back(left.is_given() ? "--left" : "--right");
  for (const Option* option : {&sequence, &video, &synthetic}) {
    if (option->is_given()) names.push_back(option->name());
  }
  return names;
}

runs::InputPictures PictureOptions::named() const {
  runs::InputPictures pictures;
  if (left.is_given()) pictures.left = {{left.text(), ""}};
  if (right.is_given()) pictures.right = {{right.text(), ""}};
  if (sequence.is_given()) pictures.sequence = {sequence.text(), {}};
  for (const std::string& file : video.texts()) pictures.video.push_back({file, ""});
  pictures.video_layout = video_layout.text();
  pictures.synthetic = synthetic.number<std::uint64_t>();
  pictures.fit = fit.text();
  return pictures;
}

bool RunOptions::has_board_only() const {
  return !board.changes_board() && !pictures.is_given() && !frames.is_given() && !source.is_given() &&
         !fidelity.is_given() && !timing_only.is_given();
}

void RunOptions::check_together(const std::string& command, process::Problems& problems) const {
  const bool has_pictures = pictures.check_together(problems, timing_only.is_given());
  trace.check_together(problems);
  if (truth.file.is_given() && pictures.synthetic.is_given())
    problems.add("--truth: does not go with --synthetic, whose scene is its own truth");
  if (offset() && board.calibration.is_given())
    problems.add("--disparity-offset: does not go with --calibration, whose tables have an offset already");
  if (pictures.fit.is_given() && board.calibration.is_given())
    problems.add("--fit: does not go with --calibration, whose tables are for pictures of the board's size");
  if (pictures.fit.is_given() && pictures.synthetic.is_given())
    problems.add("--fit: does not go with --synthetic, whose scene has the board's size");
  if (no_record.is_given() && !out.is_given() && !page_data.is_given())
    problems.add("--no-record: goes with --out DIR");
  for (const Option* const other : {&out, &save_frames, static_cast<const Option*>(&json)}) {
    if (page_data.is_given() && other->is_given())
      problems.add("--page-data: does not go with " + other->name());
  }
  for (const auto& [name, given] :
       {std::pair("--truth", truth.file.is_given()), std::pair("--save-frames", save_frames.is_given())}) {
    if (timing_only.is_given() && given)
      problems.add(fmt::format("{}: does not go with --timing-only, which has no disparities", name));
  }
  if (!problems.empty() && board.argument.is_given())
    board.load(problems);  // all at once: those of its files too
  if (!board.argument.is_given() || !has_pictures)
    problems.add_note(
        fmt::format("a complete command: stereotlm {} fpl2003 --left left.png --right right.png", command));
}

std::uint64_t RunOptions::recorded_frames() const {
  if (!(out.is_given() || page_data.is_given()) || no_record.is_given()) return 0;
  return record.is_given() || !trace.traces().empty() ? runs::kAllFrames : runs::kRecordedFrames;
}

runs::RunInput RunOptions::load() const {
  process::Problems problems;
  runs::RunInput input;
  runs::OpenedSource opened;
  const LoadedBoard loaded = board.load(problems);
  const std::optional<runs::CalibrationInput>& calibration = loaded.calibration;
  const platform::BoardConfig* const its = loaded.board ? &*loaded.board : nullptr;
  runs::InputPictures& named = input.described;
  named = pictures.named();
  problems.attempt("",
                   [&] { opened = runs::open_source(named, its, problems, board.calibration.is_given()); });
  if (has_arrays() && its != nullptr) problems.attempt("", [&] { runs::open_arrays(opened); });
  if (calibration)
    opened.files.insert(opened.files.end(), calibration->files.begin(), calibration->files.end());
  const std::uint64_t pairs = opened.pairs ? opened.pairs->length() : 1;
  input.frames = frames.number<std::uint64_t>().value_or(pairs == runs::PairSource::kEndless ? 1 : pairs);
  if (its != nullptr) {
    check_offset(*its, offset(), problems);
    if (problems.empty()) opened.truth_offset = runs::truth_offset(*its, calibration, offset().value_or(0));
  }
  load_truth(*this, input.frames - 1, opened, input, problems);
  process::catch_interrupts();
  input.inputs = opened.files;
  input.inputs.push_back({"BOARD", board.argument.text()});
  if (out.is_given())
    problems.attempt("", [&] {
      input.folder = std::make_unique<files::OutputFolder>(out.text(), runs::result_content(input.inputs));
    });
  if (input.folder)
    input.record = [folder = input.folder.get()](const auto& name, const auto& text) {
      folder->append(name, text);
    };
  problems.check();
  input.board = *loaded.board;
  problems.attempt("", [&] {
    input.tables = runs::tables_of(input.board, calibration, offset().value_or(0));
    if (calibration) {
      input.calibration = calibration->calibration;
      input.described.calibration = calibration->described;
    }
    if (has_arrays() && input.folder && !input.timing_only)
      named.sequence = runs::keep_pictures(*opened.pairs, *input.folder);
    if (const auto sent = truth.sent.find(runs::kKeptTruth); sent != truth.sent.end() && input.folder)
      input.described.truth = runs::keep_file(runs::kKeptTruth, sent->second, *input.folder);
    describe(*this, input);
  });
  trace.check_window(input.board, input.frames, problems);
  problems.check();
  problems.attempt("--trace ", [&] { open_traces(*this, input); });
  problems.check();
  for (const std::string& note : opened.notes) process::say("note", note);
  if (input.calibration) say_what_is_not_seen(input);
  if (!input.timing_only)
    process::attempt_or_refuse("", [&] { runs::check_pair(input, opened.pairs->pair(0)); });
  input.pairs = input.timing_only ? runs::blank_pairs(input.board) : std::move(opened.pairs);
  return input;
}

}  // namespace stereotlm::cli
