#pragma once

#include <cstdint>

#include "platform/statistics.h"
#include "sw/cli/run_input.h"
#include "sw/simulation/simulation.h"

namespace stereotlm::cli {

// With --save-frames: writes the disparities of this frame aside, into the result that deliver() puts into
// place. Throws std::runtime_error if they cannot be written.
void save_frame(const RunInput& input, const simulation::Result& result);

// For a run that ended after `frames_done` frames: without the truth, and with a note that says so, if the last
// of them does not show the pair that the truth belongs to. The run is then the same as one without --truth.
void leave_out_truth_of_another_pair(RunInput& input, std::uint64_t frames_done);

// `last`: the result of the last frame. Writes the result files, prints the table and, if any, the identities that do not hold. True if they all
// hold. Throws std::runtime_error if the files cannot be written; an earlier result is then as it was.
bool deliver(RunInput& input, const platform::Statistics& statistics, const simulation::Result& last);

}  // namespace stereotlm::cli
