#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace stereotlm::platform {

// The place at which a value was written. A source overrides those with lower numbers: presets that a board
// extends, the board itself, then each `--set` in its order.
struct Place {
  static constexpr int kPreset = 0;
  static constexpr int kBoard = 1;
  static constexpr int kFirstSet = 2;

  int source = kBoard;
  int line = 1;    // from 1
  int column = 1;  // from 1, in characters
};

// A YAML value as it was written. Nothing is converted, keys may repeat, and each value has its place.
struct YamlNode {
  enum class Kind { kNull, kScalar, kList, kMap };
  struct Entry;

  Kind kind = Kind::kNull;
  Place place;
  std::string text;             // text of a scalar; of a null `~`, `null`, or nothing
  bool quoted = false;          // a scalar in quotes, or a block scalar
  std::string misuse;           // the rule that an anchor, an alias or a tag breaks here; else empty
  std::vector<YamlNode> items;  // values of a list
  std::vector<Entry> entries;   // entries of a map, in the order of the text

  bool is_map() const { return kind == Kind::kMap; }
  bool is_list() const { return kind == Kind::kList; }
  bool is_scalar() const { return kind == Kind::kScalar; }

  // The first entry with that key; nullptr if there is none.
  Entry* find(const std::string& key);
  const Entry* find(const std::string& key) const;
};

struct YamlNode::Entry {
  YamlNode key;
  YamlNode value;
};

// A text is not one YAML document. what() is the rule that it breaks.
class YamlError : public std::runtime_error {
 public:
  YamlError(const Place& error_place, const std::string& rule)
      : std::runtime_error(rule), place(error_place) {}
  Place place;
};

// Parses one YAML document. `source`: Place::source of all values. Throws YamlError for the first error of
// syntax, text that is not UTF-8, control characters, an empty text and a second document.
YamlNode parse_yaml(const std::string& text, int source);

// Parses one YAML flow value, such as `3`, `[a, b]` or `{a: 1}`. Throws YamlError.
YamlNode parse_flow_value(const std::string& text, int source);

// The value in one line in flow style, shortened to about 60 characters for a message.
std::string short_text(const YamlNode& node);

// The value in one line in flow style, in full.
std::string flow_text(const YamlNode& node);

// The map as YAML in block style. parse_yaml() reads the same values back, without `place` and `misuse`.
std::string yaml_text(const YamlNode& map);

bool is_utf8(std::string_view text);

// `text` in double quotes, with YAML's escapes.
std::string quoted_text(const std::string& text);

}  // namespace stereotlm::platform
