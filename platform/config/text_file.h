#pragma once

#include <string>

namespace stereotlm::platform {

// The whole text of a small file, such as a "board file". Throws BoardError if it cannot be read or is larger
// than 1 MiB.
std::string read_text_file(const std::string& path, const std::string& kind);

}  // namespace stereotlm::platform
