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
  // The steps that a rule between keys or the tables forbid. If all steps of a group are forbidden, only the
  // first is listed; else none of them.
  std::vector<KnobStep> forbidden;
};

// One step of every knob of a board, if the new value is in the range of its key:
//   a number: up and down by the step of its key (1; window: 2; pci.width_bits: 32); a word: each other word
//   bridge.local_clock_mhz: also the FPGA's clock, its double, and clock_in_step()
//   capture.fifo_words: also twice as many, at least the 140 of a PXC200
//   fpga.clock_mhz with `camera`: also that of the local bus if they differ by less than 10 %
//   matcher.fetch: a step to the line buffer also sets matcher.rows to 1
//   matcher.units: the fewest modules for the next lower and next higher number of folds; `all`
//   matcher.cost: each other kind (census with 5 x 5 pixels); from census also the next larger and smaller
//   matcher.filter: none; log7
//   fpga.tables: joint, in the bank of the left table or in that of the right; or separate, with the right
//   table in the first bank without buffers that can hold it, else in the bank of the joint table
//   fpga.priority: two neighbours exchanged; a port moved to the front, or to the end
//   pci.load: removed
//   ssram.banks.*.kind: all banks get another kind (a bank that gains turnaround has 2 cycles of it)
//   ssram.banks.*.turnaround_cycles: up and down by one, in all banks that have turnaround
//   allocation.left_image with right_image, and allocation.disparity: the last buffer removed; or one added,
//   in each of up to four banks (images: each pair), preferably without such a buffer, then little used
//   a bank more: a buffer leaves a shared bank for an empty one. If no empty bank can hold it, it gets a new
//   bank, which is like the shared one
//   a bank less: all buffers of one bank move into another bank that is used
// Image size, bank depth and device do not change. `camera`: whether the knobs of the computer around the
// board are included. `joint_problem`: why the tables cannot be joined; nullopt if they can.
KnobSteps knob_steps(const platform::BoardConfig& board, bool camera,
                     const std::optional<std::string>& joint_problem);

}  // namespace stereotlm::explore
