#pragma once

#include <optional>

#include "sw/cli/sweep_options.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/runs/sources/calibration_input.h"

namespace stereotlm::cli {

// Submits a sweep as jobs of Slurm, shows their progress, waits until they have ended, and returns the counts
// of the sweep. If interrupted, cancels the jobs and returns early. Throws Refused if the jobs cannot be
// submitted, and std::runtime_error if the sweep fails later.
explore::SweepCounts sweep_on_slurm(const SweepCommandOptions& options, const explore::Plan& plan,
                                    const std::optional<runs::CalibrationInput>& calibration);

}  // namespace stereotlm::cli
