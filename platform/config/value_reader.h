#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "platform/config/board_keys.h"
#include "platform/config/yaml_tree.h"

namespace stereotlm::platform {

// One problem of a board and its place. The text is `path = value: rule`.
struct Finding {
  Finding(const Place& its_place, std::string its_text) : place(its_place), text(std::move(its_text)) {}

  Place place;
  std::string text;
  bool is_between_keys = false;  // a rule between keys: each value may keep its own rule
  std::string missing;           // path of a missing key or section; else empty
};

// The path of `name` below `path`: "image.width" for "image" and "width". The top is "".
std::string below(const std::string& path, const std::string& name);

// Reads maps and single values of a board's tree. A value that breaks its rule is appended to the findings and
// returned as empty. The path and place of a value that keeps its rule are stored.
class ValueReader {
 public:
  using Entries = std::map<std::string, const YamlNode::Entry*>;

  // With `report_missing` false a missing key is no finding. `findings` must outlive the reader.
  ValueReader(bool report_missing, std::vector<Finding>& findings)
      : report_missing_(report_missing), findings_(findings) {}

  void report_between_keys(const Place& place, std::string text);
  void report(const Place& place, const std::string& path, const std::string& value, const std::string& rule);
  void report(const std::string& path, const YamlNode& node, const std::string& rule);
  void report_missing(const Place& place, const std::string& path, const std::string& rule);
  // Reports a missing key that another key's value requires.
  void report_missing_beside(const Place& place, const std::string& path, const std::string& rule);
  std::size_t finding_count() const { return findings_.size(); }

  void accept(const std::string& path, const Place& place);
  const Place* find(const std::string& path) const;  // nullptr if the path was not accepted

  // False, and reported, for an anchor, an alias or a tag.
  bool check_use(const std::string& path, const YamlNode& node);

  // The entries of a map by name. Reports a value that is no map, keys that are not in `known`, repeated keys
  // and, at the place `key`, missing keys of `required`.
  std::optional<Entries> read_entries(const std::string& path, const YamlNode& node, const Place& key,
                                      const std::vector<std::string>& known,
                                      const std::vector<std::string>& required);

  std::optional<int> read_integer(const std::string& path, const YamlNode& node, const IntegerRule& rule,
                                  const std::string& rule_text);

  // The index of the word in `words`.
  std::optional<int> read_word(const std::string& path, const YamlNode& node,
                               const std::vector<std::string>& words);

 private:
  void report_repeated(const YamlNode::Entry& entry, const YamlNode::Entry& first, const std::string& path);

  bool report_missing_;
  std::vector<Finding>& findings_;
  std::map<std::string, Place> valid_;
};

}  // namespace stereotlm::platform
