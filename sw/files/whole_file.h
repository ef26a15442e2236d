#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

namespace stereotlm::files {

// Writes a new file and makes it durable. Throws std::system_error with the cause as code if the file exists
// or a byte cannot be stored. The caller then removes the file.
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

// Reads the whole content. Throws std::runtime_error with path and cause if it is no readable regular file. A
// file longer than `most_bytes` is refused before it is read.
std::string read_whole_file(const std::filesystem::path& path,
                            std::uintmax_t most_bytes = std::numeric_limits<std::uintmax_t>::max());

// Makes the entries of a folder durable. Throws std::system_error.
void sync_folder(const std::filesystem::path& folder);

}  // namespace stereotlm::files
