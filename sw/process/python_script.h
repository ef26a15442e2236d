#pragma once

#include <string>
#include <vector>

#include "sw/process/command.h"

namespace stereotlm::process {

inline constexpr const char* kPython = "/usr/bin/python3";

// Replaces this process by one of the scripts that are installed with the program: what it says and its exit
// status are the program's. Throws std::runtime_error if there is no such script, or no `python`.
[[noreturn]] void become_script(const std::string& script, const std::vector<std::string>& arguments,
                                const std::string& python = kPython);

// Runs one of them and waits for its end; what it says is not shown, and Ctrl-C does not reach it. Throws as
// become_script() does.
CommandEnd run_script(const std::string& script, const std::vector<std::string>& arguments,
                      const std::string& python = kPython);

}  // namespace stereotlm::process
