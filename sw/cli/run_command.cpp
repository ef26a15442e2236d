#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "models/binder.h"
#include "platform/bounds.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/progress.h"
#include "sw/runs/run_input.h"
#include "sw/runs/run_results.h"
#include "sw/runs/verification.h"

namespace stereotlm::cli {
namespace {

using runs::Simulation;

// Builds the simulation. If that fails, refuses the command, because no cycle has been simulated yet.
std::unique_ptr<Simulation> build(const runs::RunInput& input, Binder& binder) {
  try {
    return runs::make_simulation(input.board, input.tables, *input.pairs, input.mode(), binder);
  } catch (const std::exception& error) {
    process::refuse(fmt::format("the board cannot be built: {}", error.what()));
  }
}

std::uint64_t least_frame_cycles(const runs::RunInput& input) {
  std::uint64_t cycles = 1;
  for (const auto& bound :
       platform::frame_bounds(input.board, platform::frame_accesses(input.board, input.tables), 0)) {
    cycles = std::max(cycles, bound.cycles);
  }
  return cycles;
}

// Simulates all frames. After an interrupt, simulates only until the frames that the core has begun are
// finished.
void simulate(Simulation& simulation, const runs::RunInput& input, runs::Verification* verification) {
  const std::uint64_t frame_cycles = least_frame_cycles(input);
  runs::Records records(input, [&input](const std::string& name, const std::string& text) {
    input.folder->append(name, text);
  });
  runs::ProgressLine progress;
  bool ends_early = false;
  while (!simulation.finished()) {
    if (process::interrupted() && !ends_early) {
      ends_early = true;
      simulation.end_early();
      progress.erase();
      if (!simulation.finished()) {
        process::say("note",
                     "interrupted: frames that the core has begun are finished first; another Ctrl-C ends "
                     "immediately, "
                     "without results");
      }
      continue;
    }
    for (const runs::Result& result : simulation.advance()) {
      runs::save_frame(input, result);
      if (verification != nullptr) verification->add(result);
    }
    records.add(simulation);
    const runs::RunState state = {simulation.frames(), simulation.frames_done(), simulation.cycles_of_done(),
                                  simulation.cycles(), frame_cycles};
    progress.show([&state](double seconds) { return runs::progress_text(state, seconds); });
  }
  records.finish(simulation);
}

void say_verified(const runs::RunInput& input) {
  process::say("note", fmt::format("verified: fast and cycle agree in every {} of {} frame{}",
                                   input.timing_only ? "figure and time" : "figure, time and pixel",
                                   input.frames, input.frames == 1 ? "" : "s"));
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
  Binder binder;
  const std::unique_ptr<Simulation> simulation = build(input, binder);
  if (input.trace_window) simulation->trace(*input.trace_window, *input.trace, *input.trace);
  simulate(*simulation, input, verification ? &*verification : nullptr);
  const std::uint64_t done = simulation->frames_done();
  if (done < input.frames) {
    process::say("note", fmt::format("interrupted after {} of {} frames{}", done, input.frames,
                                     done == 0 ? ": there is no result" : ""));
    if (verification) runs::leave_out_verify(input);
    if (done == 0) return kInterrupted;
    runs::leave_out_truth_of_another_pair(input, done);
  }
  const platform::Statistics statistics = simulation->statistics();
  runs::Verification::Outcome compared;
  const bool compares = verification && done == input.frames;
  if (compares) compared = verification->compare(statistics);
  if (compared.interrupted) runs::leave_out_verify(input);
  if (input.trace) input.trace->complete();  // before the earlier result is replaced: this may fail
  const bool is_right = runs::deliver(input, statistics, simulation->last(), compared.failed);
  if (input.trace) input.trace->commit();
  if (!is_right) return kFailed;
  if (done < input.frames || compared.interrupted) return kInterrupted;
  if (compares) say_verified(input);
  return kDone;
}

}  // namespace

void add_run(CLI::App& program, Action& action) {
  add_command(
      program, action, "run", "Simulate a board on pairs of pictures", run,
      "Ctrl-C ends the run with the results of the frames that are finished; with cameras, --record or\n"
      "--trace those that the core has begun are finished first.");
}

}  // namespace stereotlm::cli
