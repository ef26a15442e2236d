#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::platform {

// One problem of a board.
struct Diagnostic {
  std::string place;             // `file:line:column`, `--set path`, or a file or preset as a whole
  std::string text;              // `full.path = value: rule`, `full.path: missing: rule`, or a rule alone
  bool is_between_keys = false;  // the rule involves several keys: each of them could be changed
  bool is_missing = false;       // of a key that is not there
};

// All problems of a board, in the order of its file, then of the `--set` options. what() has one line,
// `place: text`, for each of the first kMostLines problems, a line that counts the rest, and the note, if
// any.
class BoardError : public std::runtime_error {
 public:
  static constexpr std::size_t kMostLines = 20;  // of what()

  // `diagnostics`: at least one. `note`: a last line, or empty.
  explicit BoardError(std::vector<Diagnostic> diagnostics, const std::string& note = "");
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }  // all problems

 private:
  std::vector<Diagnostic> diagnostics_;
};

// Returns the whole text of a file. `kind` is the kind of file in messages, such as "board file". Throws
// BoardError if it cannot be read or is larger than 1 MiB.
std::string read_text_file(const std::string& path, const std::string& kind);

// Loads a board (contract section 4). `board` is the path of a board file if it has a `/` or ends in `.yaml`,
// else the name of a preset. `sets` are `path=value` pairs. They are applied in order after presets are
// merged. Each value is one YAML flow value. It replaces the whole value at its path, or is added there, so
// that a bank can be added. The result is checked once, at the end. Throws BoardError.
BoardConfig load_board(const std::string& board, const std::vector<std::string>& sets = {});

// The board as a complete board file, without `extends`. load_board() reads it back to an equal BoardConfig.
// `ssram.default` has the values of the first bank; the other banks give only the values that differ. There
// is no `pci.load` if the board has none.
std::string to_yaml(const BoardConfig& board);

// The value of a key: a number, or a text. Lists and maps are texts of one line.
using KeyValue = std::variant<std::int64_t, double, std::string>;

// One value of a board.
struct BoardValue {
  std::string path;  // "image.width", "ssram.banks.bank0.words"
  KeyValue value;
};

// Every value of a valid board with its path, in the order of to_yaml(). Lists, words and filters are text as
// in to_yaml(), in one line. Each bank has all its values. A board without `pci.load` has no values below it.
std::vector<BoardValue> values_of(const BoardConfig& board);

// The values of `--set` that turn `from` into `to`, in this order: those of banks; pci.load=none if only
// `from` has a load; the others as in to_yaml(). If two or more banks differ or are new, or if banks go or
// change their places, `ssram.default` and `ssram.banks` are given whole.
std::vector<std::string> sets_between(const BoardConfig& from, const BoardConfig& to);

// A board file that is compiled in.
struct Preset {
  std::string_view name;  // for load_board() and `extends`
  std::string_view text;  // of the file
};

// All presets, `fpl2003` first.
const std::vector<Preset>& presets();

// Their names.
std::vector<std::string> preset_names();

// The preset of which fewest values of `--set` make the board, and these, as by sets_between().
std::pair<std::string, std::vector<std::string>> sets_of_nearest_preset(const BoardConfig& board);

// The text of a preset's file. Throws std::out_of_range for an unknown name.
std::string_view preset_text(std::string_view name);

}  // namespace stereotlm::platform
