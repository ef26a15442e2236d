#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <stdexcept>

#include "models/binder.h"
#include "platform/figures/bounds.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/files/aside.h"
#include "sw/files/text_forms.h"
#include "sw/process/child.h"
#include "sw/report/page_data/page_data.h"
#include "sw/report/page_data/recording_data.h"
#include "sw/runs/progress.h"
#include "sw/runs/run_input.h"
#include "sw/runs/run_results.h"
#include "sw/runs/verification.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;
using runs::Simulation;

// What a run has found.
struct Outcome {
  std::uint64_t frames_done = 0;
  platform::Statistics statistics;  // of these frames; only if there are any
  runs::Result last;
};

std::uint64_t assumed_frame_cycles(const runs::RunInput& input) {
  const platform::FrameAccesses accesses = platform::frame_accesses(input.board, input.tables);
  return platform::turn_bounds(input.board, accesses).front().cycles;
}

// Simulates all frames; after an interrupt, only until the frames that the core has begun are finished.
Outcome simulate(const runs::RunInput& input, runs::Verification* verification) {
  Binder binder;
  std::unique_ptr<Simulation> simulation;
  process::attempt_or_refuse("the board cannot be built: ", [&] {
    simulation = runs::make_simulation(input.board, input.tables, *input.pairs, input.mode(), binder);
  });
  if (input.trace && input.trace->window())
    simulation->trace(input.trace->window()->cycles, *input.trace, *input.trace);
  const std::uint64_t frame_cycles = assumed_frame_cycles(input);
  runs::Records records(input);
  runs::ProgressLine progress(
      fmt::format("{} frames are simulated", input.frames),
      input.fast ? runs::stepped_text(input.board, input.tables, input.camera) : "--fidelity cycle");
  bool ends_early = false;
  simulation->run([&] {
    if (process::interrupted() && !ends_early) {
      ends_early = true;
      simulation->end_early();
      progress.erase();
      if (!simulation->finished()) {
        process::say("note",
                     "interrupted: frames that the core has begun are finished first; another Ctrl-C ends "
                     "immediately, "
                     "without results");
      }
    }
    for (const runs::Result& result : simulation->take_results()) {
      runs::save_frame(input, result);
      if (verification != nullptr) verification->add(result);
    }
    records.add(*simulation);
    const runs::RunState state = {simulation->frames(), simulation->frames_done(),
                                  simulation->cycles_of_done(), simulation->cycles(), frame_cycles};
    progress.show(state.frames_done, state.frames,
                  [&state](double seconds) { return runs::progress_text(state, seconds); });
  });
  records.finish(*simulation);
  Outcome outcome;
  outcome.frames_done = simulation->frames_done();
  if (outcome.frames_done > 0) outcome.statistics = simulation->statistics();
  outcome.last = simulation->last();
  return outcome;
}

// Prints a note about each trace that will be large. A child process traces a sample of the run, without
// pixels: some frames, or with a window some cycles of a frame. The whole is larger in proportion.
void say_large_traces(runs::RunInput& input, const TraceOptions& options) {
  constexpr double kLarge = 200e6;  // bytes
  constexpr std::uint64_t kFrames = 64;
  constexpr std::uint64_t kCycles = 8192;
  std::optional<trace::TraceWindow> window = input.trace->window();
  if (window && window->around_longest_wait) return;  // shows few cycles
  const files::TemporaryFolder folder;
  process::Child child([&](const process::Child::Tell& tell) {
    std::vector<trace::TraceFile> files = options.traces();
    for (std::size_t i = 0; i < files.size(); ++i) files[i].path = folder.path() / std::to_string(i);
    const auto all = static_cast<double>(input.frames);
    const std::uint64_t begin = assumed_frame_cycles(input) / 8;
    const fpga::CycleWindow whole = window.value_or(trace::TraceWindow()).cycles;
    const std::uint64_t frame = whole.frame.value_or(0) % platform::allocation_period_frames(input.board);
    if (window) window->cycles = {frame, fpga::CycleWindow::Unit::kCycles, begin, begin + kCycles - 1};
    static_cast<void>(input.trace.release());  // its files are those of the parent
    input.trace = std::make_unique<trace::Trace>(files, input.board, window);
    input.pairs = runs::blank_pairs(input.board);
    input.fast = input.timing_only = true;
    input.recorded_frames = 0;
    input.described.save_frames = false;
    input.frames = window ? frame + 1 : std::min(input.frames, kFrames);
    process::leave_out_notes(true);
    const Outcome outcome = simulate(input, nullptr);
    input.trace->complete();
    input.trace->commit();
    double size = all / static_cast<double>(input.frames);  // of the whole, in samples
    if (window) {
      const auto of_frame = static_cast<double>(outcome.statistics.frame_cycles.back());
      const bool has_rows = whole.unit == fpga::CycleWindow::Unit::kRows;
      const double unit = has_rows ? of_frame / input.board.image.height : 1;  // cycles
      const double most = whole.frame ? of_frame : of_frame * all;
      size = std::min((static_cast<double>(whole.last) + 1) * unit, most) -
             static_cast<double>(whole.first) * unit;
      size /= std::min<double>(kCycles, of_frame - static_cast<double>(begin));
    }
    for (const trace::TraceFile& file : files)
      tell(fmt::to_string(size * static_cast<double>(fs::file_size(file.path))));
  });
  for (const std::string& trace : options.files.texts()) {
    const double bytes = std::stod(child.next().value());
    if (bytes < kLarge) continue;
    process::say("note", fmt::format("--trace '{}': will take about {:.0f} MB{}: fewer --frames, or a short "
                                     "--trace-window such as frame=F,rows=A..B, make it smaller",
                                     trace, bytes / 1e6,
                                     fs::path(trace).extension() == ".fst" ? " before it is FST" : ""));
  }
}

struct RunCommandOptions : Options {
  using Options::Options;
  void check_together(process::Problems& problems) override { run.check_together("run", problems); }

  RunOptions run{this, this, this};
};

int run(const RunCommandOptions& options) {
  runs::RunInput input = options.run.load();
  try {
    if (input.trace) say_large_traces(input, options.run.trace);
  } catch (const std::runtime_error& error) {  // a run that fails says so again
    process::say("note", fmt::format("--trace: the size of the traces is not known: {}", error.what()));
  }
  std::optional<runs::Verification> verification;
  if (options.run.verify.is_given()) verification.emplace(input);
  std::optional<report::RecordingData> recording;
  if (options.run.page_data.is_given() && input.recorded_frames > 0) {
    recording.emplace(input.board, input.camera);
    input.record = [&recording](const auto& name, const auto& text) { recording->add(name, text); };
  }
  const Outcome outcome = simulate(input, verification ? &*verification : nullptr);
  const std::uint64_t done = outcome.frames_done;
  if (done < input.frames) {
    process::say("note", fmt::format("interrupted after {} of {} frames{}", done, input.frames,
                                     done == 0 ? ": there is no result" : ""));
    if (verification) runs::leave_out_verify(input);
    if (done == 0) return kInterrupted;
    runs::leave_out_truth_of_another_pair(input, done);
  }
  const bool compares = verification && done == input.frames;
  const auto differences =
      compares ? verification->compare(outcome.statistics) : std::optional(std::vector<std::string>());
  if (!differences) runs::leave_out_verify(input);
  if (input.trace) input.trace->complete();  // before the earlier result is replaced: this may fail
  std::function<std::string(const stats::TableExtras&)> text_of;
  if (options.run.page_data.is_given()) {
    if (recording) recording->check(outcome.statistics);
    text_of = [&](const stats::TableExtras& extras) {
      return files::json_text(report::run_data(input, outcome.statistics, extras, outcome.last,
                                               recording ? &*recording : nullptr));
    };
  }
  const bool is_right = runs::deliver(input, outcome.statistics, outcome.last,
                                      differences.value_or(std::vector<std::string>()), text_of);
  if (input.trace) input.trace->commit();
  if (!is_right) return kFailed;
  if (done < input.frames || !differences) return kInterrupted;
  if (compares) {
    process::say("note", fmt::format("verified: fast and cycle agree in every {} of {} frame{}",
                                     input.timing_only ? "figure and time" : "figure, time and pixel", done,
                                     done == 1 ? "" : "s"));
  }
  return kDone;
}

}  // namespace

void add_run(Commands& commands) {
  add_command(commands, "run", "Simulate a board on pairs of pictures", run,
              "Ctrl-C ends the run with the results of the frames that are finished; with cameras, --out or\n"
              "--trace those that the core has begun are finished first.");
}

}  // namespace stereotlm::cli
