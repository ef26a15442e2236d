#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/kernels/integer_rule.h"
#include "platform/config/board_config.h"
#include "platform/config/board_yaml.h"
#include "platform/yaml/words.h"
#include "platform/yaml/yaml_tree.h"

namespace stereotlm::platform {

using kernels::IntegerRule;

// The allowed values of a decimal number.
struct DecimalRule {
  double min;  // the least value
  double max;  // the greatest value

  bool allows(double value) const { return value >= min && value <= max; }  // false for NaN
};

class ValueReader;

// The values that a key allows: integers, decimal numbers and words. A list or a map has code of its own.
struct ValueRule {
  std::string text;                          // such as "0..253 or off"
  std::optional<IntegerRule> integers = {};  // nullopt: none
  std::optional<DecimalRule> decimals = {};  // nullopt: none
  std::vector<std::string> words = {};       // in the order of their enumeration

  bool allows_number(const YamlNode& number) const;  // true without a rule for numbers
};

// How to get a value of a board or of a bank, and how to set it to a value that its rule allows.
template <typename Owner>
struct Access {
  std::function<KeyValue(const Owner&)> get;
  std::function<void(Owner&, const KeyValue&)> set;
};

// A key of board files. board_keys() has each key once, with its rule. Reader, writer, problems(), `keys`,
// the JSON Schema, `--set`, sweeps and knobs follow from it.
struct Key {
  std::string path;     // dotted; NAME stands for a bank's name
  std::string meaning;  // one line
  std::string unit;     // empty: none
  ValueRule rule;
  Access<BoardConfig> access = {};  // of a value that is a number or a word; null for any other
  // `write`: the value as YAML. `read`: sets the board to the value of `entry`, or reports what is wrong with
  // it. Null for `pci.load`, for a part of the value of another key, and for a key of a bank.
  std::function<YamlNode(const BoardConfig&)> write = nullptr;
  std::function<void(ValueReader&, const Key&, const YamlNode::Entry& entry, BoardConfig&)> read = nullptr;
  bool is_optional = false;  // may be missing from its map
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
// The value in a board that has it.
KeyValue value_of(const Key& key, const BoardConfig& board);
// The value as a text, such as "7", "29.97" and "off".
std::string value_text(const KeyValue& value);
YamlNode value_node(const KeyValue& value);  // the value as YAML

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

// The known path nearest to an unknown one; empty if none is near. The distance is the least of the edit
// distance behind the common sections, and that of the last names + 2. So the right name in a wrong section
// is nearer than most wrong names in the right section.
std::string nearest_path(const std::string& path, const std::vector<std::string>& known);

// The message for an unknown path: "unknown key; nearest known key: PATH", or the keys of its section, or a
// text that says that no known key is near.
std::string unknown_key_text(const std::string& path);

// A cost as a board file has it: "sad", "{census: 5}".
std::string cost_text(const kernels::MatchingCost& cost);

// A key of `ssram.default` and of a bank.
inline constexpr const char* kEnergySection = "energy";
struct BankKey {
  std::string name;     // the path below that of the bank
  std::string meaning;  // one line
  std::string unit;     // empty: none
  ValueRule rule;
  Access<BankConfig> access;
  // Banks of this kind need the key. For banks of all other kinds it has no effect. In one entry with another
  // kind it is an error. nullopt: every bank has a value.
  std::optional<memory::BankKind> kind = {};
  // Of the energy, which may be missing: whether the bank gives it. Null for any other key.
  std::function<bool(const BankConfig&)> is_given = nullptr;
};
const std::vector<BankKey>& bank_keys();  // in the order of board files
// Whether the bank needs the key: refresh_cycles only with a refresh.
bool needs_key(const BankConfig& bank, const BankKey& key);

// For messages about is_bank_name().
inline constexpr const char* kBankNameRule = "a bank's name is [A-Za-z][A-Za-z0-9_-]*, and not none";
bool is_bank_name(std::string_view name);  // whether the name keeps kBankNameRule

// The name of a bank in texts, tables, figures and waveforms, so that it is told from a part of the model:
// `bank` and a number as it is, such as "bank0"; any other name behind `bank`, such as "bank matcher". Files,
// JSON and databases keep the name.
std::string bank_text(const std::string& name);

}  // namespace stereotlm::platform
