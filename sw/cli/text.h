#pragma once

#include <cstddef>
#include <string>

namespace stereotlm::cli {

inline constexpr std::size_t kTextColumns = 100;

// Wraps `text` to lines of at most kTextColumns columns; a longer word has a line of its own. The first line
// begins with `head`, padded to `indent`; the others are indented by `indent`. Each line ends with a newline.
std::string paragraph(const std::string& head, std::size_t indent, const std::string& text);

}  // namespace stereotlm::cli
