#pragma once

#include <string>

namespace stereotlm::platform {

// Returns the whole text of a file. `kind` is the kind of file in messages, such as "board file". Throws
// BoardError if the file cannot be read or is larger than 1 MiB.
std::string read_text_file(const std::string& path, const std::string& kind);

}  // namespace stereotlm::platform
