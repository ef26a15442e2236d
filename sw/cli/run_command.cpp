#include <fmt/format.h>

#include "models/binder.h"
#include "platform/bounds.h"
#include "platform/preloaded_system.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/runs/progress.h"
#include "sw/runs/run_input.h"
#include "sw/runs/run_results.h"
#include "sw/runs/verification.h"

namespace stereotlm::cli {
namespace {

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
  if (input.trace_window) simulation->trace(*input.trace_window, *input.trace, *input.trace);
  const std::uint64_t frame_cycles = assumed_frame_cycles(input);
  runs::Records records(input, [&input](const std::string& name, const std::string& text) {
    input.folder->append(name, text);
  });
  runs::ProgressLine progress;
  bool ends_early = false;
  while (!simulation->finished()) {
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
      continue;
    }
    for (const runs::Result& result : simulation->advance()) {
      runs::save_frame(input, result);
      if (verification != nullptr) verification->add(result);
    }
    records.add(*simulation);
    const runs::RunState state = {simulation->frames(), simulation->frames_done(),
                                  simulation->cycles_of_done(), simulation->cycles(), frame_cycles};
    progress.show(state.frames_done, state.frames,
                  [&state](double seconds) { return runs::progress_text(state, seconds); });
  }
  records.finish(*simulation);
  Outcome outcome;
  outcome.frames_done = simulation->frames_done();
  if (outcome.frames_done > 0) outcome.statistics = simulation->statistics();
  outcome.last = simulation->last();
  return outcome;
}

// Whether the counts of the core alone are all that is wanted: count_cycles() has them without the modules.
bool has_counts_only(const runs::RunInput& input, bool verifies) {
  return !input.camera && input.fast && input.timing_only && !input.record && !input.trace && !verifies;
}

// The same figures as simulate(), of the core alone without pixels, in a third of the time.
Outcome count_cycles(const runs::RunInput& input) {
  const std::uint64_t frame_cycles = assumed_frame_cycles(input);
  runs::ProgressLine progress;
  Outcome outcome;
  outcome.statistics = platform::run_core(
      input.board, input.tables, input.frames, [&](std::uint64_t done, std::uint64_t cycles) {
        outcome.frames_done = done;
        const runs::RunState state = {input.frames, done, cycles, cycles, frame_cycles};
        progress.show(done, input.frames,
                      [&](double seconds) { return runs::progress_text(state, seconds); });
        return !process::interrupted();
      });
  return outcome;
}

struct RunCommandOptions : Options {
  using Options::Options;
  void check_together(process::Problems& problems) override { run.check_together("run", problems); }

  RunOptions run{this, this};
};

int run(const RunCommandOptions& options) {
  runs::RunInput input = options.run.load();
  std::optional<runs::Verification> verification;
  if (options.run.verify.is_given()) verification.emplace(input);
  const Outcome outcome = has_counts_only(input, verification.has_value())
                              ? count_cycles(input)
                              : simulate(input, verification ? &*verification : nullptr);
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
  const bool is_right = runs::deliver(input, outcome.statistics, outcome.last,
                                      differences.value_or(std::vector<std::string>()));
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
  add_command(
      commands, "run", "Simulate a board on pairs of pictures", run,
      "Ctrl-C ends the run with the results of the frames that are finished; with cameras, --record or\n"
      "--trace those that the core has begun are finished first.");
}

}  // namespace stereotlm::cli
