#pragma once

#include <cstddef>
#include <string>

namespace stereotlm::files {

// SHA-256 as 64 lower-case hexadecimal digits.
std::string sha256_hex(const void* bytes, std::size_t count);

// Of the file's content, read in pieces. Throws std::runtime_error naming path and cause if it cannot be
// read.
std::string sha256_file(const std::string& path);

}  // namespace stereotlm::files
