#pragma once

#include <functional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::platform {

// A rule between several keys that a board breaks.
struct BrokenRule {
  std::string text;  // `path = value: rule`
  // Dotted paths of the values that take part; the first is the one that the text names. An element of a list
  // is `allocation.disparity[1]`.
  std::vector<std::string> involved;
};

// Every broken rule between keys, in the order of the keys. `is_valid(path)` tells whether a value keeps its
// own rule. A rule is checked only if all values that take part do.
std::vector<BrokenRule> broken_rules(const BoardConfig& board,
                                     const std::function<bool(const std::string&)>& is_valid);

// "[bank0, bank1]"
std::string list_text(const std::vector<std::string>& words);

}  // namespace stereotlm::platform
