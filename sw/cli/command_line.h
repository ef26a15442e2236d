#pragma once

#include "sw/cli/commands.h"

namespace stereotlm::cli {

// Parses the arguments and returns the action that main() runs. For --help and --version, the action prints
// the text. Throws Refused if the arguments are wrong.
Action parse_command_line(int argc, const char* const* argv);

}  // namespace stereotlm::cli
