#pragma once

#include <filesystem>
#include <string>

namespace stereotlm::process {

inline constexpr const char* kVersion = STEREOTLM_VERSION;  // version of the project, set by CMake

// The path of a file that is installed with the program. `from_program`: its path relative to the folder of
// the program.
std::filesystem::path installed_path(const std::string& from_program);

}  // namespace stereotlm::process
