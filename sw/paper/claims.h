#pragma once

#include <string>
#include <vector>

#include "sw/paper/verdict.h"

namespace stereotlm::paper {

// A board as a command line names it. It is run without pixels for explore::frames_of() frames.
struct BoardRun {
  std::string preset;
  std::vector<std::string> sets;  // KEY=VALUE
  bool camera = false;            // true: the whole computer; false: the core alone
};

// The quantity that is compared.
enum class Quantity {
  // Frames per second of the first run: of the core alone, or of the computer from the first delivery to the
  // last. Further runs are shown beside it.
  kRate,
  kSlices,   // % of the FPGA's slices that the first run's board uses
  kSpread,   // highest rate of the runs minus the lowest
  kSpeedUp,  // rate of the first run divided by that of the second
  // The fewest banks for which some allocation reaches the best rate of the first run's board. Proved over all
  // allocations.
  kBanksProved,
  // The fewest banks among the runs that reach the rate of the first run.
  kBanksFound,
};

// "frames/s", "% of the slices", "times", "banks"
std::string unit_of(Quantity quantity);

struct Case {
  std::string name;  // "7x7, the core alone"
  double printed = 0;
  std::vector<BoardRun> runs;
};

// A statement of the paper with numbers.
struct Claim {
  std::string name;   // "table1": one word, also used in the files
  std::string place;  // place in the paper: "Table 1"
  std::string says;   // the statement in a few words
  Quantity quantity = Quantity::kRate;
  Rule rule;
  double half_digit = 0;  // rounding of the printed value: half of its last digit
  std::vector<Case> cases;
};

// All numbers of the paper that are compared: place, boards and rule of each. The sizes of Table 2 are in
// table_2(): the area model is fitted to them.
std::vector<Claim> claims();

}  // namespace stereotlm::paper
