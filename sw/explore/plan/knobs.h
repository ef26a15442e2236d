#pragma once

#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/explore/plan/points.h"

namespace stereotlm::explore {

// A board that differs from another by one step of one knob.
struct KnobStep {
  std::string knob;  // a key, or "a bank more", "a bank less"
  std::string from;
  std::string to;
  platform::BoardConfig board;
  bool changes_disparities = false;  // other disparities come out of it
  // Of the steps of a knob that stand for one decision (which buffer gets the new bank) only the best
  // matters.
  bool only_best = false;
};

// One step of every knob of a board, as far as there is such a board:
//   a number: up and down by one (the window by two); a word: each other one
//   fpga.priority: two neighbours exchanged
//   ssram.banks.*.kind: all banks of another kind (a bank that gains turnaround has 2 cycles of it)
//   ssram.banks.*.turnaround_cycles: of all banks that have any, up and down by one
//   allocation.left_image, right_image, and allocation.disparity: a buffer more, in the bank of the first,
//   or less
//   a bank more: a buffer that shares its bank gets a new one, like that
//   a bank less: the buffers of one bank move into another that is used
// The size of the images, the depth of banks and the device stay. `camera`: of the whole computer, else the
// knobs of the board alone.
std::vector<KnobStep> knob_steps(const platform::BoardConfig& board, bool camera);

// These boards, in their order.
class BoardPoints : public Points {
 public:
  BoardPoints(std::vector<platform::BoardConfig> boards, const PointRun& run)
      : boards_(std::move(boards)), run_(run) {}
  std::uint64_t size() const override { return boards_.size(); }
  Point point(std::uint64_t number) const override { return make_point(number, boards_.at(number), run_); }
  const std::vector<Condition>& conditions() const override { return none_; }

 private:
  std::vector<platform::BoardConfig> boards_;
  PointRun run_;
  std::vector<Condition> none_;
};

}  // namespace stereotlm::explore
