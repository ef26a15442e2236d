#pragma once

#include <cstdint>
#include <systemc>
#include <vector>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/kernels/lr_check.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The left-right check (paper section 2.3; contract 1.4). For each column it takes the match of unit A, then
// that of unit B. It passes on the checked disparity of the left pixel D-1 columns back, from the first pixel
// of the frame on. Each of the R rows has its own check. Results of rows outside the image are dropped here.
class LrCheck : public sc_core::sc_module {
 public:
  StreamOut<Disparity> disparities_out{"disparities_out"};  // in the order of the columns; row by row in each

 private:
  void take_right(const RightMatch& match) { right_ = match.disparity; }
  void take_left(const LeftMatch& match) {
    kernels::LrCheck& check = checks_[static_cast<std::size_t>(match.row)];
    const Disparity checked{match.row, check.step(match.disparity, match.left_valid, right_)};
    if (columns_to_skip_ == 0 && geometry_.is_inside(first_row_ + match.row)) disparities_out->push(checked);
    if (match.row + 1 == geometry_.rows) next_column();
  }

 public:
  StreamIn<RightMatch, LrCheck, &LrCheck::take_right> right_in{"right_in", this};  // of unit A
  StreamIn<LeftMatch, LrCheck, &LrCheck::take_left> left_in{"left_in", this};      // then those of B

  // The configuration has no problems.
  LrCheck(const sc_core::sc_module_name& name, const CoreConfig& config)
      : sc_module(name),
        geometry_(config),
        checks_(static_cast<std::size_t>(config.rows),
                kernels::LrCheck(config.disparities, config.lr_tolerance)) {}

  void start_frame() {  // to be called before the first column of a frame
    for (kernels::LrCheck& check : checks_) check.start_frame();
    // A result leaves result_delay_columns columns after its own column. The filter and the window, which lie
    // before this stage, cause a part of that delay.
    columns_to_skip_ =
        geometry_.result_delay_columns - static_cast<std::uint64_t>(geometry_.half + geometry_.radius);
    column_ = 0;
    first_row_ = 0;
  }

 private:
  void next_column() {
    if (columns_to_skip_ > 0) {
      --columns_to_skip_;
      return;
    }
    if (++column_ < geometry_.width) return;
    column_ = 0;
    first_row_ += geometry_.rows;
  }

  FrameGeometry geometry_;
  std::vector<kernels::LrCheck> checks_;  // [row of a strip]; the matches of a column come in this order
  std::uint8_t right_ = 0;                // the match of unit A
  std::uint64_t columns_to_skip_ = 0;
  int column_ = 0;     // column of the next results
  int first_row_ = 0;  // first row of the next results
};

}  // namespace stereotlm::fpga
