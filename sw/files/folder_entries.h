#pragma once

#include <filesystem>
#include <vector>

namespace stereotlm::files {

// Names of the entries of a folder, sorted. Throws std::filesystem::filesystem_error.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

// Whether an entry exists, is a regular file, is a folder. A symbolic link exists, but is neither file nor
// folder.
bool is_there(const std::filesystem::path& path);
bool is_file(const std::filesystem::path& path);
bool is_folder(const std::filesystem::path& path);

}  // namespace stereotlm::files
