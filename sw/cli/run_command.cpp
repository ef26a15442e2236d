#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "platform/bounds.h"
#include "sw/cli/add_command.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/interrupt.h"
#include "sw/cli/progress.h"
#include "sw/cli/run_input.h"
#include "sw/cli/run_mode.h"
#include "sw/cli/run_options.h"
#include "sw/cli/run_results.h"
#include "sw/cli/streams.h"
#include "sw/cli/verification.h"

namespace stereotlm::cli {
namespace {

using simulation::Simulation;

// What can go wrong here is known before the first cycle.
std::unique_ptr<Simulation> build(const RunInput& input, host::FrameSource& pairs, Binder& binder) {
  try {
    return simulation::make_simulation(input.board, input.tables, pairs, run_mode(input), binder);
  } catch (const std::exception& error) {
    refuse(fmt::format("the board cannot be built: {}", error.what()));
  }
}

std::uint64_t least_frame_cycles(const RunInput& input) {
  std::uint64_t cycles = 1;
  for (const auto& bound : platform::frame_bounds(input.board, input.tables, 0)) {
    cycles = std::max(cycles, bound.cycles);
  }
  return cycles;
}

// Until the last frame, or the end of an interruption.
void simulate(Simulation& simulation, const RunInput& input, Verification* verification) {
  const std::uint64_t frame_cycles = least_frame_cycles(input);
  ProgressLine progress;
  bool ends_early = false;
  while (!simulation.finished()) {
    if (interrupted() && !ends_early) {
      ends_early = true;
      simulation.end_early();
      progress.erase();
      if (!simulation.finished()) {
        say("note",
            "interrupted: what the core has begun is finished first; another Ctrl-C ends at once, "
            "without results");
      }
      continue;
    }
    for (const simulation::Result& result : simulation.advance()) {
      save_frame(input, result);
      if (verification != nullptr) verification->add(result);
    }
    progress.show({simulation.frames(), simulation.frames_done(), simulation.cycles_of_done(),
                   simulation.cycles(), frame_cycles});
  }
}

void say_verified(const RunInput& input) {
  say("note", fmt::format("verified: fast and cycle agree in every {} of {} frame{}",
                          input.timing_only ? "figure and time" : "figure, time and pixel", input.frames,
                          input.frames == 1 ? "" : "s"));
}

int run(const RunOptions& options) {
  RunInput input = load_run_input(options);
  std::optional<Verification> verification;
  if (options.verify) verification.emplace(input, options);
  Binder binder;
  simulation::BlankPairs blank(input.board);
  host::FrameSource& pairs = input.timing_only ? static_cast<host::FrameSource&>(blank) : *input.pairs;
  const std::unique_ptr<Simulation> simulation = build(input, pairs, binder);
  simulate(*simulation, input, verification ? &*verification : nullptr);
  const std::uint64_t done = simulation->frames_done();
  if (done < input.frames) {
    say("note", fmt::format("interrupted after {} of {} frames{}", done, input.frames,
                            done == 0 ? ": there is no result" : ""));
    if (verification) leave_out_verify(input);
    if (done == 0) return kInterrupted;
    leave_out_truth_of_another_pair(input, done);
  }
  const platform::Statistics statistics = simulation->statistics();
  Verification::Outcome compared;
  const bool compares = verification && done == input.frames;
  if (compares) compared = verification->compare(statistics);
  if (compared.interrupted) leave_out_verify(input);
  if (!deliver(input, statistics, simulation->last(), compared.failed)) return kFailed;
  if (done < input.frames || compared.interrupted) return kInterrupted;
  if (compares) say_verified(input);
  return kDone;
}

}  // namespace

void add_run(CLI::App& program, Action& action) {
  const auto options = std::make_shared<RunOptions>();
  const auto parsed = [options, &action] {
    options->check_usage();
    action = [options] { return run(*options); };
  };
  options->add_to(add_command(program, "run", "Simulate a board on pairs of pictures", parsed));
}

}  // namespace stereotlm::cli
