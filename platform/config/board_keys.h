#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "models/kernels/integer_rule.h"
#include "platform/config/board_config.h"
#include "platform/yaml/words.h"
#include "platform/yaml/yaml_tree.h"

namespace stereotlm::platform {

using kernels::IntegerRule;

class ValueReader;
struct Key;

// board_keys() has each key of board files once, with its rule. Reader, writer, problems(), `keys`, `--set`,
// sweeps and knobs follow from it. If a board has no `pci.load`, `field` of a key below `pci.load` throws
// std::bad_optional_access.
struct IntegerKey {
  int* (*field)(BoardConfig&);  // the value in a board
};

// A key whose value is a decimal number.
struct DecimalKey {
  double min;                      // least value
  double max;                      // greatest value
  double* (*field)(BoardConfig&);  // the value in a board

  bool allows(double value) const { return value >= min && value <= max; }  // false for NaN
};

// A key whose value is one of a few words. If the board's value is none of them, `get` returns the value as a
// text for messages. `set` uses the index of the word in `words`.
struct WordKey {
  std::vector<std::string> words;                      // the allowed words
  std::function<std::string(const BoardConfig&)> get;  // the word of the board
  std::function<void(BoardConfig&, int)> set;          // index in `words`
};

// A key of board files.
struct Key {
  std::string path;     // dotted; NAME stands for a bank's name
  std::string meaning;  // one line
  std::string unit;     // empty: none
  std::variant<std::monostate, IntegerKey, DecimalKey, WordKey> kind;  // monostate: any other
  std::string rule_text;                                               // the range or the allowed values
  std::optional<IntegerRule> numbers;  // the rule for integers; nullopt: takes none
  bool is_optional = false;            // may be missing from its map
  // `write`: the value as YAML. `read`: sets the board to the value of `entry`, or reports what is wrong with
  // it. Null for `pci.load`, for a part of the value of another key, and for a key of a bank.
  std::function<YamlNode(const BoardConfig&)> write = nullptr;
  std::function<void(ValueReader&, const Key&, const YamlNode::Entry& entry, BoardConfig&)> read = nullptr;
  std::string no_number = "";  // the word that an integer may be instead, such as "off"; empty: none
};

inline constexpr std::size_t kMostBuffers = 3;  // entries of an image or disparity list

// All keys, in the order in which the writer of board files writes them.
const std::vector<Key>& board_keys();
std::vector<Key> keys();                       // `extends`, then board_keys()
const Key* find_key(std::string_view path);    // nullptr if there is no such key
const Key& board_key(std::string_view path);   // throws std::out_of_range
bool has_key(const BoardConfig&, const Key&);  // false for a key below a `pci.load` that is not given

// Whether boards have a value of this key.
inline bool has_value(const Key& key) { return key.write != nullptr; }
// `pci.load`: `none`, or a map of the keys below it.
inline bool is_section(const Key& key) { return key.path == "pci.load"; }
// Whether the key allows a number. True for a key without a rule for numbers.
bool allows_number(const Key& key, const YamlNode& number);

// The path of `name` below `path`: "image.width" for "image" and "width". The top is "".
std::string below(const std::string& path, const std::string& name);

// Whether the path is one below `section`.
bool is_below(std::string_view path, std::string_view section);

// The names of the keys directly below a path ("" is the top), in order; empty below a single value.
const std::vector<std::string>& child_keys(std::string_view path);

// The keys of child_keys() that are not optional.
const std::vector<std::string>& required_keys(std::string_view path);

// The number of required keys at or below the path, where all banks count as one key. "" is the whole board.
std::size_t required_count(std::string_view path);

// The rule of a key. The rule of a map lists its keys: "a map of width, height".
std::string rule_text(std::string_view path);

// `path` with NAME in place of a bank's name: `ssram.banks.NAME.words` for `ssram.banks.bank0.words`.
std::string schema_path(const std::string& path);

// The message for an unknown path: "unknown key; nearest known key: PATH", or a text that says that no known
// key is near.
std::string unknown_key_text(const std::string& path);

// The beginning of a message. The allowed words follow, as listed().
inline constexpr const char* kMustBeOneOf = "must be one of ";

// A cost as a board file has it: "sad", "{census: 5}".
std::string cost_text(const kernels::MatchingCost& cost);

// The names that board files use for the kinds of banks, in the order of memory::BankKind.
const std::vector<std::string>& bank_kind_names();
// A key of `ssram.default` and of a bank that is required for banks of one kind, and without effect for all
// others. In one entry with another kind it is an error.
struct BankTimingKey {
  const char* name;               // last part of the path
  memory::BankKind kind;          // which banks need it
  const char* meaning;            // one line
  const char* unit;               // empty: none
  IntegerRule rule;               // allowed values
  bool is_power_of_two;           // whether only 1, 2, 4, .. are allowed
  bool may_be_off;                // 0 stands for off
  int (*get)(const BankConfig&);  // the value in a bank
  void (*set)(BankConfig&, int);  // sets the value in a bank

  std::string rule_text() const;  // of the value
};
const std::vector<BankTimingKey>& bank_timing_keys();  // in the order of board files
// Whether the bank needs the key: refresh_cycles only with a refresh.
bool needs_key(const BankConfig& bank, const BankTimingKey& key);

// For messages about is_bank_name().
inline constexpr const char* kBankNameRule = "a bank's name is [A-Za-z][A-Za-z0-9_-]*, and not none";
bool is_bank_name(std::string_view name);  // whether the name keeps kBankNameRule

// The name of a bank in texts, tables, figures and waveforms, so that it is told from a part of the model:
// `bank` and a number as it is, such as "bank0"; any other name behind `bank`, such as "bank matcher". Files,
// JSON and databases keep the name.
std::string bank_text(const std::string& name);

}  // namespace stereotlm::platform
