#pragma once

#include <filesystem>
#include <string>

namespace stereotlm::process {

// Where something lies that is installed with the program, from its path relative to the program's folder.
std::filesystem::path installed_path(const std::string& from_program);

}  // namespace stereotlm::process
