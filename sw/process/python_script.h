#pragma once

#include <string>
#include <vector>

#include "sw/process/command.h"

namespace stereotlm::process {

inline constexpr const char* kPython = "/usr/bin/python3";

// Runs one of the scripts that are installed with the program as run_command() does, until an interrupt, and
// returns its output. Throws std::runtime_error if the script or `python` does not exist.
CommandEnd run_script(const std::string& script, const std::vector<std::string>& arguments,
                      const std::string& python = kPython);

}  // namespace stereotlm::process
