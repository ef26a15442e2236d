#pragma once

#include <string>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::platform::testing {

// Loads the text as the file `board.yaml` of a folder of its own.
BoardConfig load_text(const std::string& text, const std::vector<std::string>& sets = {});

// What load_text() refuses the text with, the file's name without its folder; empty if it is a board.
std::string refusal_of(const std::string& text, const std::vector<std::string>& sets = {});

// The same for a preset or a path.
std::string refusal_of_board(const std::string& board, const std::vector<std::string>& sets);

// Expects that boards are refused with these messages. An empty message: the text is a board.
struct Refusal {
  std::string text;
  std::string message;
  std::vector<std::string> sets = {};  // beside the text
};
void expect_refusals(const std::vector<Refusal>& refusals);

// A whole board, the paper's but with the deepest banks and a load on the PCI bus, with each single value in
// a line of its own.
std::string block_board();

// block_board() with another value at the path of a single value or a whole map, and that value's place.
struct ChangedBoard {
  std::string text;
  std::string place;  // "board.yaml:3:10"
};
ChangedBoard board_with(const std::string& path, const std::string& value);

}  // namespace stereotlm::platform::testing
