#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace stereotlm::process {

inline constexpr const char* kVersion = STEREOTLM_VERSION;  // version of the project, set by CMake

// Returns the address of a symbol of a plugin: a library that uses OpenCV and is installed with the program.
// The first call loads the library, and OpenCV with it; both stay loaded. Removes environment variables that
// configure OpenCV (OPENCV_..). Throws std::runtime_error if the library cannot be loaded. `what` completes
// its message "the library that ..".
const void* plugin_symbol(const std::string& library_name, const char* symbol, const std::string& what);

// Thrown if the program was not found.
class CommandMissing : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The output of a program and the way in which it ended.
struct CommandEnd {
  int status = 0;  // exit status, or 128 + the number of the signal that ended it
  std::string out;
  std::string errors;
};

// Runs the program words[0], searched in PATH, with the other words as arguments, without a shell, and waits
// for its end. Its standard input is empty. Its environment is that of this process without the variables
// whose names begin with one of `hidden`. Ctrl-C in a terminal does not reach the program. It is
// killed when this process ends. `waiting`: called every 10 ms until then; interrupted() ends it with
// SIGTERM; null: neither. Throws CommandMissing and std::system_error.
CommandEnd run_command(const std::vector<std::string>& words, const std::vector<std::string>& hidden = {},
                       const std::function<void()>& waiting = nullptr);

inline constexpr const char* kPython = "/usr/bin/python3";

// Runs one of the scripts that are installed with the program as run_command() does, until an interrupt, and
// returns its output. Throws std::runtime_error if the script or `python` does not exist.
CommandEnd run_script(
    const std::string& script, const std::vector<std::string>& arguments, const std::string& python = kPython,
    const std::function<void()>& waiting = [] {});

// Becomes the main() of a module of the Python package that is installed with the program. It gets the
// arguments, and `--page N`: a descriptor from which it reads `page`. Throws std::runtime_error if there is
// no such package, and std::system_error.
[[noreturn]] void become_python(const std::string& module, const std::vector<std::string>& arguments,
                                const std::string& page);

}  // namespace stereotlm::process
