#pragma once

#include <functional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::platform {

// A rule between several keys that a board breaks.
struct BrokenRule {
  std::string text;  // `path = value: rule`
  // The values that take part, as dotted paths; first the one that the text names. An element of a list is
  // `allocation.disparity[1]`.
  std::vector<std::string> involved;
};

// Every broken rule between keys, in the order of the keys. `is_valid(path)` says whether the value of a key
// is known to keep its own rule; a rule that involves another value is not checked.
std::vector<BrokenRule> broken_rules(const BoardConfig& board,
                                     const std::function<bool(const std::string&)>& is_valid);

// "[bank0, bank1]"
std::string list_text(const std::vector<std::string>& words);

}  // namespace stereotlm::platform
