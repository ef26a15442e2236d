#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/board_yaml.h"
#include "platform/config/value_reader.h"
#include "platform/config/yaml_tree.h"

namespace stereotlm::platform {

// Whether a board is given by the path of its file: it has a / or ends in .yaml; else by the name of a
// preset.
bool is_board_file(const std::string& board);

// What is wrong with the path of a value that is to be replaced; empty if the schema has it.
std::string path_problem(const std::string& path);

// A board as a file or preset has it, with all that it extends, before it is read; then with values replaced.
// It may be copied: of one file a sweep makes many boards.
class BoardDraft {
 public:
  // `board` as for load_board(). Throws BoardError if there is no tree: an unknown preset, a file that cannot
  // be read, an error of syntax. What else is wrong is said by read().
  explicit BoardDraft(const std::string& board);

  // `path=value`, as `--set` gives it.
  void set(const std::string& assignment);

  // Puts the value at that path of the schema, whether there is one or not. Messages call its place
  // `file:line:column`, as the value has them.
  void replace(const std::string& path, YamlNode value, const std::string& file);

  // The problems that the value has at that path whatever the other keys are. The rest of the board is not
  // read. Places are as for replace().
  std::vector<Diagnostic> problems_of(const std::string& path, const YamlNode& value,
                                      const std::string& file) const;

  // A board, and everything that is wrong with it. The board has all values of the draft if every problem is
  // between keys.
  struct Reading {
    BoardConfig board;
    std::vector<Diagnostic> problems;
  };
  Reading read_with_problems() const;

  // Throws BoardError with everything that is wrong.
  BoardConfig read() const;

  // A board file with the same values: it is read to the same board, or refused for the same reasons.
  std::string to_yaml() const { return yaml_text(tree_); }

 private:
  // Where a value comes from.
  struct Source {
    std::string name;
    bool has_lines = false;
  };

  static BoardDraft of_preset(std::string_view name);

  BoardDraft() = default;
  void resolve_extends();
  std::string text_of(const Place& place) const;
  Place next_place() const { return {Place::kFirstSet + static_cast<int>(sources_.size()), 1, 1}; }

  std::string board_name_;       // of the file or preset, for messages
  std::vector<Source> sources_;  // of the values that were replaced, by Place::source - Place::kFirstSet
  YamlNode tree_;
  bool has_extends_ = false;
  bool is_whole_ = true;  // false: the preset that it extends could not be found
  std::vector<Finding> findings_;
};

}  // namespace stereotlm::platform
