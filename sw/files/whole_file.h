#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

namespace stereotlm::files {

// Writes a new file and makes it durable. Throws std::system_error, whose code is the cause, if any byte
// could not be stored: what is left of the file is then the caller's to remove. An existing file is an error.
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

// The whole content. Throws std::runtime_error that names the path and the cause if it is no regular file
// that can be read, or longer than `most_bytes`, which is found out before it is read.
std::string read_whole_file(const std::filesystem::path& path,
                            std::uintmax_t most_bytes = std::numeric_limits<std::uintmax_t>::max());

// With ReplacedFile: the file is there whole, or as it was. Throws std::system_error.
void replace_file(const std::filesystem::path& path, std::string_view bytes);

// Makes the names in a folder durable. Throws std::system_error.
void sync_folder(const std::filesystem::path& folder);

}  // namespace stereotlm::files
