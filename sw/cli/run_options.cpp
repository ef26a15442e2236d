#include "sw/cli/run_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "calib/calibration.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "sw/files/text_forms.h"
#include "sw/process/installation.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/run_json.h"
#include "sw/runs/sources/calibration_library.h"
#include "sw/runs/sources/open_source.h"

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

void is_window(const Option& option, process::Problems& problems) {
  if (option.is_given() && !window_of(option.text()))
    problems.add(fmt::format("--trace-window = '{}': must be {}", option.text(), kWindowForms));
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

// Whether `inner` is the folder or lies below it, after resolving links and dots. False if either does not
// exist.
bool lies_in(const fs::path& inner, const fs::path& folder) {
  std::error_code no_inner;
  std::error_code no_folder;
  const fs::path inside = fs::canonical(inner, no_inner).lexically_relative(fs::canonical(folder, no_folder));
  return !no_inner && !no_folder && *inside.begin() != "..";
}

class InputLoader {
 public:
  explicit InputLoader(const RunOptions& options) : options_(options) {}

  runs::RunInput load() {
    auto [board, calibration] = options_.board.load(problems_);
    problems_.attempt("", [&, &board = board] { load_pictures(board ? &*board : nullptr); });
    if (calibration)
      source_.files.insert(source_.files.end(), calibration->files.begin(), calibration->files.end());
    check_truth();
    process::catch_interrupts();
    input_.inputs = source_.files;
    input_.inputs.push_back({"BOARD", options_.board.name()});
    if (options_.out.is_given()) {
      problems_.attempt("", [&] {
        input_.folder =
            std::make_unique<files::OutputFolder>(options_.out.text(), runs::result_content(input_.inputs));
      });
    }
    problems_.check();
    input_.board = *board;
    problems_.attempt("", [&, &calibration = calibration] {
      input_.tables = runs::tables_of(input_.board, calibration);
      if (calibration) {
        input_.calibration = calibration->calibration;
        input_.described.calibration = calibration->described;
      }
      input_.config_yaml = platform::to_yaml(input_.board);
      describe();
    });
    options_.trace.check_window(input_.board, input_.frames, problems_);
    problems_.check();
    open_traces();
    problems_.check();
    for (const std::string& note : source_.notes) process::say("note", note);
    if (input_.calibration) say_what_is_not_seen();
    if (input_.calibration && !options_.timing_only.is_given())
      problems_.attempt("", [&] { say_how_rows_agree(); });
    problems_.check();
    input_.pairs = std::move(source_.pairs);
    return std::move(input_);
  }

 private:
  void load_pictures(const platform::BoardConfig* board) {
    source_ = runs::open_source(options_.pictures.source(), board, input_.described, problems_);
    if (!options_.truth.file()) return;
    const runs::NamedFile file = {"--truth", *options_.truth.file()};
    source_.files.push_back(file);
    input_.truth = runs::open_truth(file, options_.truth.scale(), board, problems_);
    if (!input_.truth) return;
    problems_.attempt(file.option + ' ', [&] {
      input_.described.truth = {fs::absolute(file.path).string(), files::sha256_file(file.path)};
    });
  }

  void check_truth() {
    if (!options_.truth.file() || !options_.source.is_camera() || !source_.pairs ||
        source_.pairs->length() == 1)
      return;
    problems_.add(fmt::format(
        "--truth: cameras drop frames: which of {} pairs the last frame shows is not known before the run: "
        "must be a run with one pair, or with --source preloaded",
        source_.pairs->length()));
  }

  void open_traces() {
    const std::vector<trace::TraceFile> files = options_.trace.files();
    const auto window = options_.trace.window();
    if (files.empty()) return;
    if (window) input_.trace_window = window->cycles;
    problems_.attempt("--trace ", [&] {
      for (const trace::TraceFile& file : files) {
        const fs::path folder = trace::outputs_of(file).front().parent_path();
        if (!options_.out.is_given() || !lies_in(folder, options_.out.text())) continue;
        throw std::runtime_error(
            fmt::format("'{}': inside the result folder '{}', which is replaced whole: must lie "
                        "outside the folder of --out",
                        file.path, options_.out.text()));
      }
      input_.trace = std::make_unique<trace::Trace>(files, input_.board, window);
    });
  }

  // Prints how well the rows of the rectified pictures match. A poor match gives a warning: the calibration
  // may be of another rig, which its file alone does not reveal.
  void say_how_rows_agree() {
    constexpr double kDoubtful = 1.5;  // pixels
    constexpr std::size_t kFew = 10;
    constexpr std::size_t kMany = 50;
    const host::StereoPair& pair = source_.pairs->pair(0);
    const calib::MatchedRows rows = runs::calibration_functions().matched_rows(
        kernels::rectify(pair.left, *input_.tables.left), kernels::rectify(pair.right, *input_.tables.right),
        input_.board.matcher.disparities);
    const std::string what = fmt::format(
        "--calibration: of {} conspicuous points of the first left picture {} are found "
        "in the right one",
        rows.points, rows.error.corners);
    if (rows.error.corners < kFew) {
      const bool is_doubtful = rows.points >= kMany;
      process::say(is_doubtful ? "warning" : "note",
                   what + (is_doubtful ? ": is it of this rig, and are left and right not exchanged?"
                                       : ": too few to see whether it is of this rig"));
      return;
    }
    const bool is_doubtful = rows.error.mean_px > kDoubtful;
    process::say(is_doubtful ? "warning" : "note",
                 fmt::format("{}; their rows differ by {:.2f} pixels on average{}", what, rows.error.mean_px,
                             is_doubtful ? ": is it of this rig?" : ""));
  }

  void say_what_is_not_seen() const {
    const int made_for = input_.calibration->disparities;
    const int has = input_.board.matcher.disparities;
    if (has >= made_for) return;
    process::say(
        "note",
        fmt::format(
            "--calibration: was made for {} disparities: the nearest objects exceed the {} of this board",
            made_for, has));
  }

  void describe() {
    const runs::PictureSource source = options_.pictures.source();
    const bool has_end = source.sequence || source.video;
    input_.camera = options_.source.is_camera();
    input_.fast = options_.is_fast();
    input_.timing_only = options_.timing_only.is_given();
    input_.record = options_.record.is_given();
    input_.json = options_.json.is_given();
    input_.frames = options_.frames.number<std::uint64_t>().value_or(has_end ? source_.pairs->length() : 1);
    runs::RecordedOptions& run = input_.described;
    run.program_version = process::kVersion;
    run.source = input_.camera ? "camera" : "preloaded";
    run.fidelity = input_.fast ? "fast" : "cycle";
    run.timing_only = input_.timing_only;
    run.verify = options_.verify.is_given();
    run.frames = input_.frames;
    run.truth_scale = options_.truth.scale();
    run.save_frames = options_.save_frames.is_given();
    run.record = input_.record;
    run_json(run);  // throws now, instead of after the run, if a path cannot be recorded
  }

  const RunOptions& options_;
  process::Problems problems_;
  runs::OpenedSource source_;
  runs::RunInput input_;
};

}  // namespace

TraceOptions::TraceOptions(Options* of)
    : files_(
          of, "--trace", "FORMAT:FILE",
          fmt::format("Write a trace of the run; FORMAT is {}; repeat it for more traces; a vcd whose FILE "
                      "ends in .fst becomes FST",
                      fmt::join(format_names(), ", ")),
          {}, Takes::kRepeated),
      window_(
          of, "--trace-window", "WINDOW",
          "Trace each cycle of a part of the run: frame=F[,rows=A..B | ,cycles=A..B] or cycles=A..B, the "
          "limits included; frames and rows count from 0, cycles from the frame's first or from power-up; "
          "with ,longest-wait only the cycles around the longest wait in it; vcd needs a window",
          {is_window, goes_with(files_, "FORMAT:FILE")}) {}

void TraceOptions::check_together(process::Problems& problems) const {
  std::set<std::filesystem::path> outputs;
  for (const std::string& text : files_.texts()) {
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
    if (file->format->needs_window && !window_.is_given())
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
                             window_.text(), *cycles.frame, frames));
  }
  const auto height = static_cast<std::uint64_t>(board.image.height);
  if (cycles.unit == fpga::CycleWindow::Unit::kRows && cycles.last >= height) {
    problems.add(fmt::format("--trace-window = '{}': row {}: must be below the rows of the image, {}",
                             window_.text(), cycles.last, height));
  }
}

std::vector<trace::TraceFile> TraceOptions::files() const {
  std::vector<trace::TraceFile> files;
  for (const std::string& text : files_.texts()) {
    if (auto file = file_of(text)) files.push_back(std::move(*file));
  }
  return files;
}

std::optional<trace::TraceWindow> TraceOptions::window() const { return window_of(window_.text()); }

TruthOptions::TruthOptions(Options* of, const std::string& picture)
    : file_(of, "--truth", "F", fmt::format("Ground truth of {}, 8-bit grey, 0 = unknown", picture)),
      scale_(
          of, "--truth-scale", "S", "Grey levels of the truth per disparity (default 1)",
          {number<double>("a number above 0", [](double scale) { return std::isfinite(scale) && scale > 0; }),
           goes_with(file_, "F")}) {}

PictureOptions::PictureOptions(Options* of)
    : left_(of, "--left", "F",
            "The left picture of one pair for every frame, 8-bit, as large as the board's images"),
      right_(of, "--right", "F", "The right picture"),
      sequence_(of, "--sequence", "DIR",
                "A folder of pairs left_*.png and right_*.png, shown in the order of their names"),
      video_(of, "--video", "F [F2]", "A video of pairs, or two videos, the left one first", {},
             Takes::kOneOrTwo),
      video_layout_(
          of, "--video-layout", "LAYOUT",
          "Where --video has the pictures of a pair: two (files), side_by_side or top_bottom (in one "
          "file, the left one in the left or upper half of each frame)",
          {goes_with(video_, "F [F2]"), one_of(runs::kVideoLayoutNames)}),
      synthetic_(of, "--synthetic", "SEED",
                 "A synthetic moving scene with known disparities; another one for each SEED, 0 or more",
                 {number<std::uint64_t>(kSeedRule)}) {}

bool PictureOptions::check_given(process::Problems& problems, bool may_be_missing) const {
  const bool is_missing = !may_be_missing && sources_given().empty();
  if (is_missing) problems.add(fmt::format("pictures: missing: a run needs {}", kPictureOptions));
  if (left_.is_given() == right_.is_given()) return !is_missing;
  problems.add(left_.is_given() ? "--right: missing: goes with --left F"
                                : "--left: missing: goes with --right F");
  return false;
}

void PictureOptions::check_together(process::Problems& problems) const {
  const std::vector<std::string> given = sources_given();
  if (given.size() > 1) {
    problems.add(
        fmt::format("{}: a run has one source of pictures: {}", fmt::join(given, ", "), kPictureOptions));
  }
  if (!video_.is_given()) return;
  const std::string& layout = video_layout_.text();
  if (!video_layout_.is_given()) {
    problems.add(fmt::format("--video-layout: missing: goes with --video, one of {}",
                             platform::listed(runs::kVideoLayoutNames)));
  } else if (runs::video_layout_of(layout)) {
    const std::size_t needed = runs::video_layout_of(layout) == runs::VideoLayout::kTwo ? 2 : 1;
    if (video_.texts().size() != needed) {
      problems.add(fmt::format("--video '{}': must name {} with --video-layout {}",
                               fmt::join(video_.texts(), "' '"), needed == 1 ? "one file" : "two files",
                               layout));
    }
  }
}

std::vector<std::string> PictureOptions::sources_given() const {
  std::vector<std::string> names;
  if (left_.is_given() || right_.is_given()) names.push_back(left_.is_given() ? "--left" : "--right");
  for (const Option* option : {&sequence_, &video_, &synthetic_}) {
    if (option->is_given()) names.push_back(option->name());
  }
  return names;
}

runs::PictureSource PictureOptions::source() const {
  runs::PictureSource source;
  if (left_.is_given()) source.pair = {left_.text(), right_.text()};
  source.sequence = sequence_.if_given();
  if (const auto layout = runs::video_layout_of(video_layout_.text()); video_.is_given() && layout)
    source.video = {video_.texts(), *layout};
  source.synthetic = synthetic_.number<std::uint64_t>();
  return source;
}

RunOptions::RunOptions(Options* of, Options* more, const std::string& beside_board)
    : board(of, beside_board),
      pictures(of),
      frames(of, "--frames", "N",
             "Frames to deliver, 1 or more; frame f of the cameras, or of the board if preloaded, shows "
             "pair f modulo the "
             "number of pairs (default 1; with --sequence and --video as many as there are pairs)",
             {number<std::uint64_t>("an integer, 1 or more", [](std::uint64_t count) { return count > 0; })}),
      source(
          of,
          "camera (the default): cameras of a whole computer; preloaded: pictures appear in their buffers in "
          "no time"),
      fidelity(of, "--fidelity", "fast|cycle",
               "How the simulation works; the results are the same to the bit and to the "
               "cycle: fast (the default), "
               "or cycle by cycle, every access a transaction",
               {one_of({"fast", "cycle"})}),
      timing_only(
          of, "--timing-only", "",
          "Leave out all pixels: the times and counts are the same, and no picture is needed; writes no "
          "disparities"),
      verify(more, "--verify", "",
             "Run at the other fidelity too, in a second process, and compare every figure, time and pixel"),
      truth(more, "the left picture that the last frame shows"),
      out(more, "--out", "DIR",
          "Folder for the result files: created if missing, else empty or an earlier result, which is "
          "replaced (default: no files)"),
      save_frames(
          more, "--save-frames", "",
          "Write the disparities of every frame too: frames/000000.png and so on in the folder of --out, "
          "numbered by camera frame",
          {goes_with(out, "DIR")}),
      record(
          more, "--record,--conflicts", "",
          "Write where and when ports wait: rows.csv and conflicts.csv in the folder of --out; with cameras "
          "also what happened when, and why it waited: timeline.csv and latency.csv",
          {goes_with(out, "DIR")}),
      trace(more),
      json(more) {}

bool RunOptions::has_board_only() const {
  return !board.changes_board() && !pictures.is_given() && !frames.is_given() && !source.is_given() &&
         !fidelity.is_given() && !timing_only.is_given();
}

void RunOptions::check_together(const std::string& command, process::Problems& problems) const {
  const bool has_pictures = pictures.check_given(problems, timing_only.is_given());
  pictures.check_together(problems);
  trace.check_together(problems);
  if (truth.file() && pictures.source().synthetic)
    problems.add("--truth: does not go with --synthetic, whose scene is its own truth");
  for (const auto& [name, given] :
       {std::pair("--truth", truth.file().has_value()), std::pair("--save-frames", save_frames.is_given())}) {
    if (timing_only.is_given() && given)
      problems.add(fmt::format("{}: does not go with --timing-only, which has no disparities", name));
  }
  if (!problems.empty() && board.is_given()) board.load(problems);  // all at once: those of its files too
  if (!board.is_given() || !has_pictures)
    problems.add_note(
        fmt::format("a complete command: stereotlm {} fpl2003 --left left.png --right right.png", command));
}

runs::RunInput RunOptions::load() const { return InputLoader(*this).load(); }

}  // namespace stereotlm::cli
