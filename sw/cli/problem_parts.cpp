#include "sw/cli/problem_parts.h"

#include <algorithm>
#include <cctype>

namespace stereotlm::cli {
namespace {

// The first colon with a blank behind it that is outside of brackets and quotes; npos if there is none.
std::size_t end_of_value(std::string_view text) {
  int depth = 0;
  char quote = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char letter = text[at];
    if (quote != 0) {
      if (letter == quote) quote = 0;
    } else if (letter == '"' || letter == '\'') {
      quote = letter;
    } else if (letter == '[' || letter == '{') {
      ++depth;
    } else if (letter == ']' || letter == '}') {
      --depth;
    } else if (depth == 0 && text.substr(at, 2) == ": ") {
      return at;
    }
  }
  return std::string_view::npos;
}

bool is_key(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '_' || letter == '-' || letter == '.';
  });
}

}  // namespace

ProblemParts parts_of(std::string_view text) {
  constexpr std::string_view kMissing = ": missing: ";
  const std::size_t missing = text.find(kMissing);
  if (missing != std::string_view::npos && is_key(text.substr(0, missing)))
    return {std::string(text.substr(0, missing)), "",
            "missing: " + std::string(text.substr(missing + kMissing.size()))};
  const std::size_t equals = text.find(" = ");
  if (equals != std::string_view::npos && is_key(text.substr(0, equals))) {
    const std::string_view rest = text.substr(equals + 3);
    const std::size_t end = end_of_value(rest);
    if (end != std::string_view::npos)
      return {std::string(text.substr(0, equals)), std::string(rest.substr(0, end)),
              std::string(rest.substr(end + 2))};
  }
  return {"", "", std::string(text)};
}

}  // namespace stereotlm::cli
