#pragma once

#include <string>
#include <string_view>

namespace stereotlm::cli {

// The parts of the text of a platform::Diagnostic. `key = value: rule` has all three, `key: missing: rule` has
// no value, and a rule alone has neither. A part that is absent is empty.
struct ProblemParts {
  std::string key;
  std::string value;
  std::string rule;
};
ProblemParts parts_of(std::string_view text);

}  // namespace stereotlm::cli
