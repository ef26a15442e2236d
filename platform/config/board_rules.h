#pragma once

#include <cstdint>
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

// One buffer of the allocation.
struct Buffer {
  std::string key;   // "allocation.left_image"
  int index;         // in its list; -1: a table, which is not a list
  std::string bank;  // its name

  // "allocation.left_image[0]", "allocation.left_lut"
  std::string path() const { return index < 0 ? key : key + '[' + std::to_string(index) + ']'; }
};

// All buffers in the order in which they lie in a bank that they share (contract 1.5).
std::vector<Buffer> buffers(const AllocationConfig& allocation);

// Depth of a buffer in 32-bit words.
std::uint64_t buffer_words(const Buffer& buffer, const ImageConfig& image);

// "[bank0, bank1]"
std::string list_text(const std::vector<std::string>& words);

}  // namespace stereotlm::platform
