#pragma once

#include <functional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::platform {

// A broken rule that involves several keys.
struct BrokenRule {
  std::string text;  // `path = value: rule`
  // Dotted paths of the values that the rule involves; the first is the one that the text begins with. An
  // element of a list is `allocation.disparity[1]`.
  std::vector<std::string> involved;
};

// Returns every broken rule between keys, in the order of the keys. `is_valid(path)` returns whether the
// value at the path keeps its own rule. A rule between keys is checked only if all values that it involves
// are valid.
std::vector<BrokenRule> broken_rules(const BoardConfig& board,
                                     const std::function<bool(const std::string&)>& is_valid);

}  // namespace stereotlm::platform
