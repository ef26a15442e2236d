#pragma once

#include <string>
#include <vector>

#include "sw/process/command.h"

namespace stereotlm::process {

inline constexpr const char* kPython = "/usr/bin/python3";

// Replaces this process by one of the scripts that are installed with the program; the output and the exit
// status of the script are those of the program. Throws std::runtime_error if the script or `python` does not
// exist.
[[noreturn]] void become_script(const std::string& script, const std::vector<std::string>& arguments,
                                const std::string& python = kPython);

// Runs one of the scripts as run_command() does, and returns its output. Throws as become_script() does.
CommandEnd run_script(const std::string& script, const std::vector<std::string>& arguments,
                      const std::string& python = kPython);

}  // namespace stereotlm::process
