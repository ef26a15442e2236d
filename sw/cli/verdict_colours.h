#pragma once

#include <string>

namespace stereotlm::cli {

// What `paper` prints, with the verdict of each claim in colour if standard output is a terminal.
std::string with_coloured_verdicts(const std::string& summary);
// What `diff` prints, with the words of its last sentence in colour likewise.
std::string with_coloured_sentence(const std::string& text);

}  // namespace stereotlm::cli
