#pragma once

#include "sw/cli/run_options.h"
#include "sw/runs/run_input.h"

namespace stereotlm::cli {

// Loads and checks the inputs of a run. Throws Refused with all problems. Prints on standard error which
// pictures were converted to grey. Checking pictures may take long. An interrupt during that time ends the
// process, which has not changed anything yet. Afterwards interrupts are caught (catch_interrupts()).
runs::RunInput load_run_input(const RunOptions& options);

}  // namespace stereotlm::cli
