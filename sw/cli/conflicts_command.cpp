#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "models/binder.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/files/output_folder.h"
#include "sw/report/conflicts_text.h"
#include "sw/runs/progress.h"
#include "sw/runs/recorded_run.h"
#include "sw/runs/run_results.h"
#include "sw/stats/record_csv.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = "conflicts.csv";  // the file that is moved into place last
constexpr const char* kConflictsFooter =
    "Printed are who waits at which bank for whom, and where in the picture. Written are conflicts.csv,\n"
    "waits by tile, which is a group of four columns in the rows of results that leave at once; and\n"
    "rows.csv, cycles, waits and accesses of every frame by rows. The page of report draws them.\n"
    "A RUN is repeated from its config.yaml and run.json, after a check of every input by its SHA-256, and\n"
    "must give the figures of its stats.json. The sums of what is written equal the figures of the run.";

// The options of `conflicts`: those of `run` that say what is simulated, or a folder of a run.
struct ConflictsOptions : Options {
  using Options::Options;

  bool is_of_run() const {
    std::error_code none;
    return fs::is_regular_file(fs::path(run.board.argument.text()) / files::kResultMark, none);
  }

  void check_together(process::Problems& problems) override {
    if (!is_of_run()) {
      run.check_together("conflicts", problems);
    } else if (!run.has_board_only()) {
      problems.add(fmt::format("'{}': a run is repeated as it was: no option of run goes with it",
                               run.board.argument.text()));
    }
  }

  RunOptions run{this, this, nullptr, "; or RUN, a folder that run --out has written"};
  Option out = Option(this, "--out", "DIR", "The folder to write, created if missing (default: no files)");
  JsonOption json{this};
};

files::OutputContent content_of(const runs::RunInput& input) {
  files::OutputContent content;
  content.called = "folder of conflicts";
  content.mark = kMark;
  content.kind = files::marked_kind("table of stereotlm conflicts", {{0, stats::conflicts_csv_head()}});
  content.rule =
      "must be empty or hold only files that conflicts has written, with conflicts.csv: move it away, or "
      "give "
      "another folder";
  content.names = {kMark, "rows.csv"};
  content.inputs = input.inputs;
  return content;
}

struct Subject {
  std::optional<runs::RecordedRun> recorded;  // nullopt: a board
  runs::RunInput input;
};

Subject load(const ConflictsOptions& options) {
  Subject subject;
  if (!options.is_of_run()) {
    subject.input = options.run.load();
  } else {
    process::Problems problems;
    subject.recorded = runs::load_recorded_run("RUN", options.run.board.argument.text(), problems);
    problems.check();
    subject.input = runs::open_again(*subject.recorded, problems);
    problems.check();
    subject.input.fast = true;  // the figures do not depend on the fidelity
    process::catch_interrupts();
  }
  subject.input.recorded_frames = runs::kAllFrames;
  return subject;
}

// Returns false if interrupted.
bool simulate(runs::Simulation& simulation, const runs::RunInput& input, files::OutputFolder* folder,
              fpga::FrameConflicts& sums) {
  std::uint64_t frames = 0;
  if (folder != nullptr) folder->append("rows.csv", stats::rows_csv_head(input.board));
  runs::ProgressLine progress(fmt::format("{} frames are simulated", input.frames),
                              runs::stepped_text(input.board, input.tables, input.camera));
  simulation.run([&] {
    if (process::interrupted()) return simulation.end_early();
    progress.show(simulation.frames_done(), simulation.frames(), [&](double seconds) {
      return runs::progress_text(simulation.frames_done(), simulation.frames(), "frames simulated", seconds);
    });
    simulation.take_timeline();
    for (const fpga::FrameConflicts& frame : simulation.take_conflicts()) {
      if (folder != nullptr) folder->append("rows.csv", stats::rows_csv(input.board, frames++, frame));
      report::add_frame(frame, sums);
    }
  });
  return !process::interrupted();
}

int conflicts(const ConflictsOptions& options) {
  Subject subject = load(options);
  runs::RunInput& input = subject.input;
  std::optional<files::OutputFolder> folder;
  if (options.out.is_given()) {
    process::attempt_or_refuse("", [&] { folder.emplace(options.out.text(), content_of(input)); });
  }
  Binder binder;
  const auto simulation =
      runs::make_simulation(input.board, input.tables, *input.pairs, input.mode(), binder);
  fpga::FrameConflicts sums;
  if (!simulate(*simulation, input, folder ? &*folder : nullptr, sums))
    return interrupted("nothing is written");
  const platform::Statistics statistics = simulation->statistics();
  for (const std::string& identity : statistics.failed)
    process::say("error", "identity does not hold: " + identity);
  if (!statistics.failed.empty()) return kFailed;
  if (subject.recorded)
    runs::check_repeated(*subject.recorded, runs::figures_of(statistics, simulation->last(), input));
  if (folder) {
    folder->add(kMark, stats::conflicts_csv(input.board, *simulation->conflicts()));
    folder->commit();
  }
  const auto document = report::conflicts_document(input.board, *simulation->conflicts(), sums);
  runs::say_lost_pixels(statistics);
  process::print(options.json.is_given() ? json_text(document) : report::conflicts_text(document));
  return kDone;
}

}  // namespace

void add_conflicts(Commands& commands) {
  add_command(commands, "conflicts", "Where in the picture, and when, ports wait for banks", conflicts,
              kConflictsFooter);
}

}  // namespace stereotlm::cli
