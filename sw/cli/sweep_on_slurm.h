#pragma once

#include <optional>

#include "sw/cli/sweep_options.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/runs/sources/calibration_input.h"

namespace stereotlm::cli {

// Runs a sweep as jobs of Slurm, and waits for them; shows the progress. Returns early if interrupted, after
// it has cancelled the jobs. Throws Refused, and std::runtime_error.
explore::SweepCounts sweep_on_slurm(const SweepCommandOptions& options, const explore::Plan& plan,
                                    const std::optional<runs::CalibrationInput>& calibration);

}  // namespace stereotlm::cli
