#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/board_yaml.h"
#include "platform/config/value_reader.h"
#include "platform/config/yaml_tree.h"

namespace stereotlm::platform {

// Whether `board` is the path of a file (it has a / or ends in .yaml) or the name of a preset.
bool is_board_file(const std::string& board);

// Why a value at this path cannot be replaced; empty if the schema has the path.
std::string path_problem(const std::string& path);

// A board file as a tree of YAML values, with the preset that it extends, before its values are checked.
// Values can be replaced. It may be copied: a sweep makes many boards from one file.
class BoardDraft {
 public:
  // `board` as for load_board(). Throws BoardError for an unknown preset, a file that cannot be read and an
  // error of syntax. read() reports all other problems.
  explicit BoardDraft(const std::string& board);

  // Replaces a value. `assignment` is `path=value` as in `--set`.
  void set(const std::string& assignment);

  // Replaces or adds the value at that path of the schema. Messages give its place as `file:line:column`; line
  // and column are those of `value`.
  void replace(const std::string& path, YamlNode value, const std::string& file);

  // The problems of a value at that path that do not depend on other keys. Does not check the rest of the
  // board. Places are as for replace().
  std::vector<Diagnostic> problems_of(const std::string& path, const YamlNode& value,
                                      const std::string& file) const;

  // A board and all its problems. `board` has all values of the draft if each problem is between keys.
  struct Reading {
    BoardConfig board;
    std::vector<Diagnostic> problems;
  };
  Reading read_with_problems() const;

  // Throws BoardError with all problems.
  BoardConfig read() const;

  // A board file with the same values. Reading it gives the same board or the same problems.
  std::string to_yaml() const { return yaml_text(tree_); }

 private:
  // The origin of a value.
  struct Source {
    std::string name;
    bool has_lines = false;
  };

  static BoardDraft of_preset(std::string_view name);

  BoardDraft() = default;
  void resolve_extends();
  std::string text_of(const Place& place) const;
  Place next_place() const { return {Place::kFirstSet + static_cast<int>(sources_.size()), 1, 1}; }

  std::string board_name_;       // name of the file or preset, for messages
  std::vector<Source> sources_;  // origins of replaced values, by Place::source - Place::kFirstSet
  YamlNode tree_;
  bool has_extends_ = false;
  bool is_whole_ = true;  // false: the preset that it extends does not exist
  std::vector<Finding> findings_;
};

}  // namespace stereotlm::platform
