#pragma once

#include <filesystem>
#include <vector>

namespace stereotlm::files {

// The names in a folder, sorted. Throws std::filesystem::filesystem_error.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

// Of the entry itself: a symbolic link is there, and neither a file nor a folder.
bool is_there(const std::filesystem::path& path);
bool is_file(const std::filesystem::path& path);
bool is_folder(const std::filesystem::path& path);

}  // namespace stereotlm::files
