#pragma once

#include <cstddef>
#include <string>

namespace stereotlm::files {

// The bytes in base64 (RFC 4648), padded, without line breaks.
std::string base64(const void* bytes, std::size_t size);

}  // namespace stereotlm::files
