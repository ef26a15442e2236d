#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <system_error>
#include <utility>

#include "calib/calibration.h"
#include "platform/config/board_yaml.h"
#include "sw/cli/run_options.h"
#include "sw/files/sha256.h"
#include "sw/process/installation.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/run_json.h"
#include "sw/runs/sources/calibration_library.h"
#include "sw/runs/sources/open_source.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

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
    attempt("", [&, &board = board] { load_pictures(board ? &*board : nullptr); });
    if (calibration)
      source_.files.insert(source_.files.end(), calibration->files.begin(), calibration->files.end());
    check_truth();
    process::catch_interrupts();
    input_.inputs = source_.files;
    input_.inputs.push_back({"BOARD", options_.board.name()});
    if (options_.out.is_given()) {
      attempt("", [&] {
        input_.folder =
            std::make_unique<files::OutputFolder>(options_.out.text(), runs::result_content(input_.inputs));
      });
    }
    problems_.check();
    input_.board = *board;
    attempt("", [&, &calibration = calibration] {
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
    if (input_.calibration && !options_.timing_only.is_given()) attempt("", [&] { say_how_rows_agree(); });
    problems_.check();
    input_.pairs = std::move(source_.pairs);
    return std::move(input_);
  }

 private:
  // Calls `step` and reports the exception that it throws. `option`: prefix of the message; may be empty.
  void attempt(const std::string& option, const std::function<void()>& step) {
    try {
      step();
    } catch (const std::exception& error) {
      problems_.add(option + (option.empty() ? "" : " ") + error.what());
    }
  }

  void load_pictures(const platform::BoardConfig* board) {
    source_ = runs::open_source(options_.pictures.source(), board, input_.described, problems_);
    if (!options_.truth.file()) return;
    const runs::NamedFile file = {"--truth", *options_.truth.file()};
    source_.files.push_back(file);
    input_.truth = runs::open_truth(file, options_.truth.scale(), board, problems_);
    if (!input_.truth) return;
    attempt(file.option, [&] {
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
    attempt("--trace", [&] {
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

runs::RunInput RunOptions::load() const { return InputLoader(*this).load(); }

}  // namespace stereotlm::cli
