#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/board_reader.h"
#include "platform/config/board_yaml.h"
#include "platform/yaml/yaml_tree.h"

namespace stereotlm::platform {

// Whether `board` is the path of a board file: it has a / or ends in .yaml. Otherwise it is the name of a
// preset.
bool is_board_file(const std::string& board);

// The reason for which no board has a value at this path; empty if the schema has the path.
std::string path_problem(const std::string& path);

// A board file before its values are checked: a tree of YAML values, merged with the preset that the file
// extends. load_board() puts the values of `--set` into it. A sweep copies it, and makes many boards from one
// file.
class BoardDraft {
 public:
  // `board` as for load_board(). `text`: what the board file holds, if it has been read already; else null.
  // Throws BoardError for an unknown preset, a file that cannot be read and a syntax error. read() reports
  // all other problems.
  explicit BoardDraft(const std::string& board, const std::string* text = nullptr);

  // What the board file holds; empty for a preset.
  const std::string& file_text() const { return file_text_; }

  // Replaces a value. `assignment` is `path=value` as in `--set`.
  void set(const std::string& assignment);

  // Replaces or adds the value at that path of the schema. Messages give its place as `file:line:column`,
  // with the line and column of `value`.
  void replace(const std::string& path, YamlNode value, const std::string& file);

  // The problems of this value at that path alone. Rules between keys and the rest of the board are not
  // checked. Places are as for replace().
  std::vector<Diagnostic> problems_of(const std::string& path, const YamlNode& value,
                                      const std::string& file) const;

  // The board, and every problem found. `board` is complete if each problem is a broken rule between several
  // keys. It is not complete after a problem of a single value (missing, wrong type, out of range).
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
  // The origin of a replaced value.
  struct Source {
    std::string name;        // `--set PATH`, or the path of a file
    bool has_lines = false;  // it is a file
  };

  static BoardDraft of_preset(std::string_view name);

  BoardDraft() = default;
  void resolve_extends();
  std::string place_text(const Place& place) const;
  Place next_place() const { return {Place::kFirstSet + static_cast<int>(sources_.size()), 1, 1}; }

  std::string board_name_;       // name of the file or preset, for messages
  std::string file_text_;        // see file_text()
  std::vector<Source> sources_;  // origins of replaced values, by Place::source - Place::kFirstSet
  YamlNode tree_;
  bool has_extends_ = false;
  // False if the preset that the file extends does not exist. read() then reports no missing keys.
  bool is_whole_ = true;
  std::vector<Finding> findings_;  // problems found before read()
};

}  // namespace stereotlm::platform
