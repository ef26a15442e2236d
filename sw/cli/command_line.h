#pragma once

#include "sw/cli/commands.h"

namespace stereotlm::cli {

// Parses the arguments and returns the action to run; that of --help and --version prints. Throws Refused.
Action parse_command_line(int argc, const char* const* argv);

}  // namespace stereotlm::cli
