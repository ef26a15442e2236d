#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/plain_cycle_loop.h"

// Boards of the worked values of contract sections 2 and 7, for the plain cycle loop.
namespace stereotlm::test {

// fpl2003 without filter.
inline PlainCycleInput fpl2003() {
  PlainCycleInput board;
  board.width = 640;
  board.height = 480;
  board.window = 7;
  board.disparities = 80;
  board.banks.resize(8);
  board.left_image = {0, 1};
  board.right_image = {2, 3};
  board.disparity = {4, 5};
  board.left_lut = 6;
  board.right_lut = 7;
  return board;
}

inline void put_into(PlainCycleInput& board, int tables_bank, int pictures_bank) {
  board.left_lut = board.right_lut = tables_bank;
  board.left_image = board.right_image = board.disparity = {pictures_bank};
}

// Joint tables in bank0, all else in bank1, and the word cache.
inline void in_two_banks(PlainCycleInput& board) {
  board.banks.resize(2);
  put_into(board, 0, 1);
  board.joint_tables = board.word_cache = true;
}

inline void with_log7(PlainCycleInput& board) { board.filter_half = 3; }

struct WorkedBoard {
  const char* name;
  void (*change)(PlainCycleInput&);  // of fpl2003()
  std::uint64_t frame_cycles;
  std::vector<std::string> blame = {};  // "left_lut bank0 left_pixel 534400"; those that the contract states

  friend void PrintTo(const WorkedBoard& board, std::ostream* out) { *out << board.name; }
};

inline std::vector<std::string> blame_of(const PlainCycleResult& result) {
  std::vector<std::string> rows;
  for (const auto& [who, cycles] : result.blame) {
    rows.push_back(std::string(name_of(who.port)) + " bank" + std::to_string(who.bank) + ' ' +
                   (who.by ? name_of(*who.by) : "turnaround") + ' ' + std::to_string(cycles));
  }
  return rows;
}

// The first frame of the board.
inline PlainCycleResult run(const WorkedBoard& worked) {
  PlainCycleInput board = fpl2003();
  worked.change(board);
  return run_plain_cycle_loop(board, 1);
}

}  // namespace stereotlm::test
