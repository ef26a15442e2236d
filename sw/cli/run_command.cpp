#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "platform/bounds.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/interrupt.h"
#include "sw/cli/progress.h"
#include "sw/cli/run_input.h"
#include "sw/cli/run_options.h"
#include "sw/cli/run_results.h"
#include "sw/cli/simulation.h"
#include "sw/cli/streams.h"

namespace stereotlm::cli {
namespace {

// What can go wrong here is known before the first cycle.
std::unique_ptr<Simulation> build(const RunInput& input) {
  try {
    return std::make_unique<Simulation>(input.board, input.tables, *input.pairs, input.frames);
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

// Until the last frame or an interruption.
void simulate(Simulation& simulation, const RunInput& input) {
  const std::uint64_t frame_cycles = least_frame_cycles(input);
  ProgressLine progress;
  std::uint64_t frame = 0;
  while (!simulation.finished() && !interrupted()) {
    for (const kernels::GrayImage& disparity : simulation.advance()) save_frame(input, frame++, disparity);
    progress.show({input.frames, simulation.frames_done(), simulation.cycles_of_done(), simulation.cycles(),
                   frame_cycles});
  }
}

int run(const RunOptions& options) {
  RunInput input = load_run_input(options);
  const std::unique_ptr<Simulation> simulation = build(input);
  simulate(*simulation, input);
  const std::uint64_t done = simulation->frames_done();
  if (!simulation->finished()) {
    say("note", fmt::format("interrupted after {} of {} frames{}", done, input.frames,
                            done == 0 ? ": there is no result" : ""));
    if (done == 0) return kInterrupted;
    leave_out_truth_of_another_pair(input, done);
  }
  if (!deliver(input, simulation->statistics(), simulation->disparity())) return kFailed;
  return simulation->finished() ? kDone : kInterrupted;
}

}  // namespace

void add_run(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("run", "Simulate a board on pairs of pictures");
  const auto options = std::make_shared<RunOptions>();
  options->add_to(*command);
  command->callback([options, &action] {
    options->check_usage();
    action = [options] { return run(*options); };
  });
}

}  // namespace stereotlm::cli
