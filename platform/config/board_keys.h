#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "models/kernels/integer_rule.h"
#include "platform/config/board_config.h"

namespace stereotlm::platform {

using kernels::IntegerRule;

// The schema of board files: each key with its rule, once. The reader, the writer, problems() and the `keys`
// command use this table. On a board without `pci.load`, `field` of the keys below it throws
// std::bad_optional_access.
struct IntegerKey {
  IntegerRule rule;
  int& (*field)(BoardConfig&);
};

struct DecimalKey {
  double min;
  double max;
  double& (*field)(BoardConfig&);

  bool allows(double value) const { return value >= min && value <= max; }  // false for NaN
};

// A key whose value is one of a few words. `get` and `set` use the index of the word in `words`. If the
// board's value is none of the words, `get` returns an index outside the list. `text` returns the value as a
// text for messages.
struct WordKey {
  std::vector<std::string> words;
  int (*get)(const BoardConfig&);
  void (*set)(BoardConfig&, int);
  std::string (*text)(const BoardConfig&);
};

// A key with code of its own in the reader and the writer.
struct OtherKey {
  std::optional<IntegerRule> numbers;  // the rule for numbers; nullopt: takes no numbers
};

struct Key {
  std::string path;     // dotted; NAME stands for a bank's name
  std::string meaning;  // one line
  std::string unit;     // empty: none
  std::variant<IntegerKey, DecimalKey, WordKey, OtherKey> rule;
  std::string rule_text;     // the range or the allowed values
  bool is_optional = false;  // may be missing from its map
};

// All keys, in the order in which the writer of board files writes them.
const std::vector<Key>& board_keys();
const Key& board_key(std::string_view path);  // throws std::out_of_range

// The names of the keys directly below a path ("" is the top), in order; empty below a single value.
const std::vector<std::string>& child_keys(std::string_view path);

// The keys of child_keys() that are not optional.
const std::vector<std::string>& required_keys(std::string_view path);

// The number of required keys at or below the path, where all banks count as one key. "" is the whole board.
std::size_t required_count(std::string_view path);

// The rule of a key. The rule of a map lists its keys: "a map of width, height".
std::string rule_text(std::string_view path);

// The message for an unknown path: "unknown key; nearest known key: PATH", or a text that says that no known
// key is near.
std::string unknown_key_text(const std::string& path);

// "; nearest: WORD" with the word of least edit distance, the first of equals; empty if no word is near.
std::string nearest_text(std::string_view word, const std::vector<std::string>& words);

// `path` with NAME in place of a bank's name: `ssram.banks.NAME.words` for `ssram.banks.bank0.words`.
std::string schema_path(const std::string& path);

// Joins words: "a, b or c".
std::string listed(const std::vector<std::string>& words);
// What a message says before the listed() words to one of which a value must be equal.
inline constexpr const char* kMustBeOneOf = "must be one of ";

// A cost as a board file has it: "sad", "{census: 5}".
std::string cost_text(const kernels::MatchingCost& cost);

inline constexpr std::size_t kMaximumBuffers = 3;  // entries of an image or disparity list
inline constexpr const char* kBankNameRule = "a bank's name is [A-Za-z][A-Za-z0-9_-]*, and not none";

// The names that board files use for the kinds of banks, in the order of memory::BankKind.
const std::vector<std::string>& bank_kind_names();
// The kinds of banks that have turnaround, joined by listed(): "sync_burst".
std::string turnaround_kinds();

bool is_bank_name(std::string_view name);
bool is_board_name(std::string_view name);  // UTF-8, not empty, without control characters

}  // namespace stereotlm::platform
