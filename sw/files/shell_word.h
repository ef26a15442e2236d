#pragma once

#include <string>
#include <vector>

namespace stereotlm::files {

// The word as a POSIX shell reads it: in quotes if it needs them.
std::string shell_word(const std::string& word);

// The words as a command of a POSIX shell.
std::string shell_command(const std::vector<std::string>& words);

}  // namespace stereotlm::files
