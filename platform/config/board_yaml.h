#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::platform {

// One thing wrong with a board.
struct Diagnostic {
  std::string place;             // `file:line:column`, `--set path`, or a file or preset as a whole
  std::string text;              // `full.path = value: rule`, `full.path: missing: rule`, or a rule alone
  bool is_between_keys = false;  // another value of another key can make it right
};

// Everything wrong with a board, in the order of its file, then of the `--set` options. what() has one line
// for each of the first kMostLines, `place: text`, one that counts the others, and the note, if there is one.
class BoardError : public std::runtime_error {
 public:
  static constexpr std::size_t kMostLines = 20;

  explicit BoardError(std::vector<Diagnostic> diagnostics, const std::string& note = "");
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

// The board of contract section 4. `board` is the name of a preset, or the path of a board file if it has a
// `/` or ends in `.yaml`. `sets` are `path=value` pairs: each value is one YAML flow value and replaces the
// whole value at its path of the board with all presets put in, in order; what is not there yet is added
// (also a bank). Checked once at the end. Throws BoardError.
BoardConfig load_board(const std::string& board, const std::vector<std::string>& sets = {});

// The board in full, without `extends`; load_board() reads it back to an equal BoardConfig. `ssram.default`
// is the first bank, the other banks give what differs; a `pci.load` of none is left out. Throws
// std::invalid_argument if the board has problems().
std::string to_yaml(const BoardConfig& board);

// One value of a board.
struct BoardValue {
  std::string path;  // "image.width", "ssram.banks.bank0.words"
  std::variant<std::int64_t, double, std::string> value;
};

// Every value of a valid board by its path, in the order in which boards are written: numbers as numbers;
// lists, words and filters as to_yaml() writes them in one line. Each bank has all its values; without a load
// on the PCI bus there are none of its values.
std::vector<BoardValue> values_of(const BoardConfig& board);

// The boards that are compiled in, `fpl2003` first.
std::vector<std::string> preset_names();

// The file of a preset, as it was written. Throws std::out_of_range for an unknown name.
std::string_view preset_text(std::string_view name);

// One key of a board file. A bank's keys stand under `ssram.banks.NAME`.
struct KeyInfo {
  std::string path;
  std::string meaning;
  std::string unit;   // empty: none
  std::string range;  // or the allowed values
};

// All keys, `extends` first, then in the order in which boards are written.
std::vector<KeyInfo> keys();

}  // namespace stereotlm::platform
