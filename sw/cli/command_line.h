#pragma once

#include "sw/cli/commands.h"

namespace stereotlm::cli {

// What the arguments ask for; the action of --help and --version prints. Throws Refused.
Action parse_command_line(int argc, const char* const* argv);

}  // namespace stereotlm::cli
