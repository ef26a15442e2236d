#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace stereotlm::platform {

// The place at which a value was written. A source overrides those with lower numbers: presets that a board
// extends, the board itself, then each `--set` in its order.
struct Place {
  static constexpr int kPreset = 0;    // Place::source of presets
  static constexpr int kBoard = 1;     // Place::source of a board file
  static constexpr int kFirstSet = 2;  // Place::source of the first `--set`

  int source = kBoard;  // kPreset, kBoard, or kFirstSet and above
  int line = 1;         // from 1
  int column = 1;       // from 1, in characters
};

// A YAML value as it was written. Nothing is converted, keys may repeat, and each value has its place.
struct YamlNode {
  // What the value is.
  enum class Kind { kNull, kScalar, kList, kMap };
  enum class Style { kUsual, kOther };  // yaml_text() writes maps in block style, lists in flow style
  struct Entry;

  static YamlNode map(const Place& place = {});       // a map without entries
  static YamlNode list(std::vector<YamlNode> items);  // of these items
  // A scalar that is not in quotes.
  static YamlNode plain(std::string text, const Place& place = {});
  // A scalar that every reader of YAML reads back as this text. It is in quotes where needed.
  static YamlNode word(const std::string& text);

  Kind kind = Kind::kNull;      // of the value
  Place place;                  // where it was written
  std::string text;             // text of a scalar; of a null `~`, `null`, or nothing
  bool quoted = false;          // a scalar in quotes, or a block scalar
  Style style = Style::kUsual;  // of a parsed value always kUsual
  std::string misuse;           // the rule that an anchor, an alias or a tag breaks here; else empty
  std::vector<YamlNode> items;  // values of a list
  std::vector<Entry> entries;   // entries of a map, in the order of the text

  bool is_map() const { return kind == Kind::kMap; }        // true for an empty one too
  bool is_list() const { return kind == Kind::kList; }      // true for an empty one too
  bool is_scalar() const { return kind == Kind::kScalar; }  // true for a scalar with a text
  // Whether this is a scalar with that text, with or without quotes.
  bool is(std::string_view word) const { return is_scalar() && text == word; }

  // The first entry with that key; nullptr if there is none.
  Entry* find(const std::string& key);
  const Entry* find(const std::string& key) const;

  // Adds an entry to a map, and returns its value.
  YamlNode& add(YamlNode key, YamlNode value);
};

// A key of a map with its value.
struct YamlNode::Entry {
  YamlNode key;    // may repeat in the map
  YamlNode value;  // of the key
};

// Calls `visit` with the value and with each value and key in it.
template <typename Visit>
void for_each_node(YamlNode& node, const Visit& visit) {
  visit(node);
  for (YamlNode& item : node.items) for_each_node(item, visit);
  for (YamlNode::Entry& entry : node.entries) {
    for_each_node(entry.key, visit);
    for_each_node(entry.value, visit);
  }
}

// A text is not one YAML document. what() is the rule that it breaks.
class YamlError : public std::runtime_error {
 public:
  // `error_place`: of the first broken rule.
  YamlError(const Place& error_place, const std::string& rule)
      : std::runtime_error(rule), place(error_place) {}
  Place place;  // of the first broken rule
};

// Parses one YAML document. `source`: Place::source of all values. Throws YamlError for the first error of
// syntax, text that is not UTF-8, control characters, an empty text and a second document.
YamlNode parse_yaml(const std::string& text, int source);

// Parses one YAML flow value, such as `3`, `[a, b]` or `{a: 1}`. Throws YamlError.
YamlNode parse_flow_value(const std::string& text, int source);

// Reads decimal digits with an optional minus, not in quotes; returns nullopt for anything else. A number
// beyond 64 bits becomes the largest or smallest 64-bit number, which no key allows.
std::optional<std::int64_t> integer_of(const YamlNode& node);

// Reads an integer as integer_of() does, or a number with digits on both sides of a decimal point; returns
// nullopt for anything else. A number beyond the range of double becomes infinite.
std::optional<double> decimal_of(const YamlNode& node);

// The shortest text that decimal_of() reads back as `value`, if that is finite.
std::string decimal_text(double value);

// Whether the value is a scalar in quotes, or one that no reader of YAML takes for a number, a boolean or
// null.
bool is_text(const YamlNode& node);

// The value in one line in flow style, as it was written, shortened to about 60 characters for a message.
std::string short_text(const YamlNode& node);
std::string short_text(const std::string& text);

// The value as YAML in one line in flow style.
std::string flow_text(const YamlNode& node);

// The map as YAML in block style. parse_yaml() reads the same values back, without `place` and `misuse`.
std::string yaml_text(const YamlNode& map);

// Whether this byte of a UTF-8 text belongs to a character that an earlier byte begins.
constexpr bool continues_character(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

// `text` in double quotes, with YAML's escapes.
std::string quoted_text(const std::string& text);

}  // namespace stereotlm::platform
