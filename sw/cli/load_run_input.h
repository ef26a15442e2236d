#pragma once

#include "sw/cli/run_options.h"
#include "sw/runs/run_input.h"

namespace stereotlm::cli {

// Throws Refused with everything that is wrong. Says on standard error which pictures were converted to grey.
// Once the pictures are checked, which may take long, interrupts are caught; before, they end the process,
// which has changed nothing.
runs::RunInput load_run_input(const RunOptions& options);

}  // namespace stereotlm::cli
