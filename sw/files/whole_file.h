#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace stereotlm::files {

// Throws std::system_error with this error of the system and the path.
[[noreturn]] void fail(int error, const std::filesystem::path& path);

// Throws std::runtime_error "'PATH': cause" if there is no regular file.
void check_regular_file(const std::filesystem::path& path);

// Reads the whole content. Throws std::runtime_error with path and cause if it is no readable regular file. A
// file longer than `most_bytes` is refused before it is read.
std::string read_whole_file(const std::filesystem::path& path,
                            std::uintmax_t most_bytes = std::numeric_limits<std::uintmax_t>::max());

// Makes a file, or the entries of a folder, durable, unless the file system cannot. Throws std::system_error.
void sync(const std::filesystem::path& path);

// Names of the entries of a folder, sorted. Throws std::filesystem::filesystem_error.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

// Whether the open file is the one at `path`, which is not a symbolic link.
bool is_open_at(int file, const std::filesystem::path& path);

// Whether an entry exists, is a regular file, is a folder. A symbolic link exists, but is neither of the two.
bool is_there(const std::filesystem::path& path);
bool is_file(const std::filesystem::path& path);
bool is_folder(const std::filesystem::path& path);

}  // namespace stereotlm::files
