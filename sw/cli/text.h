#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "sw/process/streams.h"

namespace stereotlm::cli {

inline constexpr std::size_t kTextColumns = 100;

// Wraps `text` to lines of at most kTextColumns columns; a longer word has a line of its own. The first line
// begins with `head`, padded to `indent`; the others are indented by `indent`. Each line ends with a newline.
std::string paragraph(const std::string& head, std::size_t indent, const std::string& text);

// The text with these words in colour, from the byte `from` on, if standard output is a terminal.
std::string with_coloured_words(std::string text, std::size_t from,
                                const std::vector<std::pair<std::string, process::Colour>>& words);

}  // namespace stereotlm::cli
