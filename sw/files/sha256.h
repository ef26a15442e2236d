#pragma once

#include <cstddef>
#include <string>

namespace stereotlm::files {

// SHA-256 as 64 lower-case hexadecimal digits.
std::string sha256_hex(const void* bytes, std::size_t count);

// The SHA-256 of the content of a file, which is read in pieces. Throws std::runtime_error with path and
// cause if the file cannot be read.
std::string sha256_file(const std::string& path);

}  // namespace stereotlm::files
