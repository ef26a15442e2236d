#pragma once

#include <string>
#include <vector>

#include "sw/paper/verdict.h"

namespace stereotlm::paper {

// A board as a command line names it, and how it is run: without pixels, for as many frames as
// explore::frames_of().
struct BoardRun {
  std::string preset;
  std::vector<std::string> sets;  // KEY=VALUE
  bool camera = false;            // the whole computer, else the core alone
};

// What is compared.
enum class Quantity {
  // Frames per second of the first run: of the core alone, or of the computer between the first delivery and
  // the last. Further runs stand beside it.
  kRate,
  kSlices,   // % of the slices of the FPGA, of the first run's board
  kSpread,   // the highest rate of the runs less the lowest
  kSpeedUp,  // the first run's rate in times of the second's
  // The fewest banks with which, of all allocations, one reaches the best rate of the first run's board.
  kBanksProved,
  // The fewest banks that one of the runs uses which reaches the rate of the first.
  kBanksFound,
};

// "frames/s", "% of the slices", "times", "banks"
std::string unit_of(Quantity quantity);

struct Case {
  std::string name;  // "7x7, the core alone"
  double printed = 0;
  std::vector<BoardRun> runs;
};

// Something that the paper says in numbers.
struct Claim {
  std::string name;   // "table1": a word, also in the files
  std::string place;  // in the paper: "Table 1"
  std::string says;   // in a few words
  Quantity quantity = Quantity::kRate;
  Rule rule;
  double half_digit = 0;  // the printed value may be off by so much: half of its last digit
  std::vector<Case> cases;
};

// Every number of the paper that is compared, with where it stands, the boards that it is about and the rule
// that decides; the sizes of Table 2 alone are explore::table_2(), to which the area is fitted.
std::vector<Claim> claims();

}  // namespace stereotlm::paper
