#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::explore {

// A board that differs from another by one step of one knob.
struct KnobStep {
  std::string knob;  // a key, or "a bank more", "a bank less"
  std::string from;
  std::string to;
  platform::BoardConfig board{};
  bool changes_disparities = false;  // the changed board computes other disparities
  // Steps of one group are alternatives (which buffer gets the bank), and only the best of them counts.
  // Empty: the step has no alternatives.
  std::string group{};
  std::vector<std::string> sets{};  // the values of `--set` that make the changed board
  std::string reason{};             // of a forbidden step: the problem of the changed board, or of the tables
};

struct KnobSteps {
  std::vector<KnobStep> possible;
  // The steps that a rule between several keys forbids, or that the tables forbid. Of a group none, if one of
  // its steps is possible; else the first.
  std::vector<KnobStep> forbidden;
};

// One step of every knob of a board, as long as the value is in the range of its key:
//   a number: up and down by one (the window by two); a word: each other one
//   matcher.fetch: the line buffer takes matcher.rows back to 1 with it
//   matcher.units: to the fewest modules that take fewer folds, to the fewest that take more, and to all
//   fpga.tables: to joint tables in the bank of the left table, or in the bank of the right table; to
//   separate tables, with the right table in the first bank without buffers that can hold it, if there is one
//   matcher.cost: each other one (census with 5 x 5 pixels); census also with the next sizes
//   fpga.priority: two neighbours exchanged; a port moved to the front, or to the end
//   pci.load: none
//   ssram.banks.*.kind: all banks get another kind (a bank that gains turnaround has 2 cycles of it)
//   ssram.banks.*.turnaround_cycles: up and down by one, in all banks that have turnaround
//   allocation.left_image, right_image, and allocation.disparity: a buffer more, in one of the banks with the
//   fewest accesses, or one less
//   a bank more: a buffer that shares its bank gets a bank that holds nothing; if there is none that can hold
//   it, a new bank, which is like the shared one
//   a bank less: all buffers of one bank move into another bank that is used
// The size of the images, the depth of banks and the device do not change. `camera`: whether the knobs of the
// computer around the board are included. `joint_problem`: why the tables of the board cannot be joined;
// nullopt if they can be joined.
KnobSteps knob_steps(const platform::BoardConfig& board, bool camera,
                     const std::optional<std::string>& joint_problem);

}  // namespace stereotlm::explore
