#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform/statistics.h"
#include "sw/runs/run_input.h"
#include "sw/runs/simulation/simulation.h"

namespace stereotlm::runs {

// With --save-frames: writes the disparities of this frame aside, into the result that deliver() puts into
// place. Throws std::runtime_error if they cannot be written.
void save_frame(const RunInput& input, const Result& result);

// For a run that ended after `frames_done` frames: without the truth, and with a note that says so, if the
// last of them does not show the pair that the truth belongs to. The run is then the same as one without
// --truth.
void leave_out_truth_of_another_pair(RunInput& input, std::uint64_t frames_done);

// For a run that was not compared as --verify asks, because it was interrupted: without --verify, and with a
// note that says so. Run again with it, a run that differs would list that in stats.json, which has not been
// found out here.
void leave_out_verify(RunInput& input);

// `last`: the result of the last frame. `differences`: from the other run of --verify. Writes the result
// files, with the differences among what has failed, prints the table and, if any, the identities that do not
// hold and the differences. True if there are none. Throws std::runtime_error if the files cannot be written;
// an earlier result is then as it was.
bool deliver(RunInput& input, const platform::Statistics& statistics, const Result& last,
             const std::vector<std::string>& differences = {});

}  // namespace stereotlm::runs
