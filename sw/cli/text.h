#pragma once

#include <cstddef>
#include <string>

namespace stereotlm::cli {

inline constexpr std::size_t kTextColumns = 100;

// `text` broken between words into lines of at most kTextColumns columns (a longer word stands alone), the
// first behind `head`, which is filled up to `indent`, the others indented by `indent`. A newline after each.
std::string paragraph(const std::string& head, std::size_t indent, const std::string& text);

}  // namespace stereotlm::cli
