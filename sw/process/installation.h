#pragma once

#include <filesystem>
#include <string>

namespace stereotlm::process {

inline constexpr const char* kVersion = STEREOTLM_VERSION;  // version of the project, set by CMake

// The path of a file that is installed with the program. `from_program`: its path relative to the folder of
// the program.
std::filesystem::path installed_path(const std::string& from_program);

// Returns the address of a symbol of a plugin: a library that uses OpenCV and is installed with the program.
// The first call loads the library, and OpenCV with it; both stay loaded. Removes environment variables that
// configure OpenCV (OPENCV_..). Throws std::runtime_error if the library cannot be loaded. `what` completes
// its message "the library that ..".
const void* plugin_symbol(const std::string& library_name, const char* symbol, const std::string& what);

}  // namespace stereotlm::process
