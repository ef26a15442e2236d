#pragma once

#include <filesystem>
#include <vector>

namespace stereotlm::files {

// Names of the entries of a folder, sorted. Throws std::filesystem::filesystem_error.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

// Whether the entry itself exists, is a file, is a folder. A symbolic link exists, and is neither of the two.
bool is_there(const std::filesystem::path& path);
bool is_file(const std::filesystem::path& path);
bool is_folder(const std::filesystem::path& path);

}  // namespace stereotlm::files
