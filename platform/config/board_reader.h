#pragma once

#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "platform/config/board_keys.h"
#include "platform/yaml/yaml_tree.h"

namespace stereotlm::platform {

// One problem of a board and its place. The text is `path = value: rule`.
struct Finding {
  Finding(const Place& its_place, std::string its_text) : place(its_place), text(std::move(its_text)) {}

  Place place;
  std::string text;
  bool is_between_keys = false;  // the rule involves several keys
  std::string missing;           // path of a missing key or section; else empty
};

// Reads maps and single values of a board's tree; read_board() uses it. If a value breaks its rule, appends a
// finding and returns nullopt. Stores the path and place of each value that keeps its rule.
class ValueReader {
 public:
  using Entries = std::vector<const YamlNode::Entry*>;

  // `findings` must outlive the reader.
  explicit ValueReader(std::vector<Finding>& findings) : findings_(findings) {}

  void report_between_keys(const Place& place, std::string text);
  void report(const Place& place, const std::string& path, const std::string& value, const std::string& rule);
  void report(const std::string& path, const YamlNode& node, const std::string& rule);
  // Reports a missing key. `is_between_keys`: the value of another key requires it.
  void report_missing(const Place& place, const std::string& path, const std::string& rule,
                      bool is_between_keys);
  std::size_t finding_count() const { return findings_.size(); }

  // Stores the path and place of a value that keeps its rule.
  void accept(const std::string& path, const Place& place);
  const Place* find(const std::string& path) const;  // nullptr if the path was not accepted

  // Reports an anchor, an alias or a tag, and returns false if the value has one.
  bool check_use(const std::string& path, const YamlNode& node);

  // Returns the entries of a map with a known key, each key once, in the order of the text. Reports unknown,
  // repeated and missing keys. Reports a value that is no map, and returns nullopt. `key` is the place of the
  // map's own key, at which missing keys are reported.
  std::optional<Entries> read_entries(const std::string& path, const YamlNode& node, const Place& key);

  // A number or a word.
  std::optional<KeyValue> read(const std::string& path, const YamlNode& node, const ValueRule& rule);

 private:
  std::vector<Finding>& findings_;
  std::unordered_map<std::string, Place> valid_;  // [path]
};

// Reads a board from its tree, after the values of the preset and of `--set` were merged into the tree.
// Appends each problem to `findings`; the result is valid only if nothing was appended.
BoardConfig read_board(const YamlNode& tree, std::vector<Finding>& findings);

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

// The tree of a board file with the values of the board. It has no `extends`. It leaves out optional keys
// that have their default.
YamlNode board_node(const BoardConfig& board);

}  // namespace stereotlm::platform
