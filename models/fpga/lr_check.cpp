#include "models/fpga/lr_check.h"

#include "models/fpga/frame_geometry.h"
#include "models/kernels/words.h"

namespace stereotlm::fpga {

LrCheck::LrCheck(const sc_core::sc_module_name& name, const CoreConfig& config)
    : sc_module(name), columns_before_frame_(0), check_(config.disparities, config.lr_tolerance) {
  const FrameGeometry geometry(config);
  // A result leaves result_delay_columns columns after its own column. The filter and the window, which lie
  // before this stage, cause a part of that delay.
  columns_before_frame_ =
      geometry.result_delay_columns - static_cast<std::uint64_t>(geometry.half + geometry.radius);
}

void LrCheck::start_frame() {
  check_.start_frame();
  columns_to_skip_ = columns_before_frame_;
  have_right_ = false;
  have_left_ = false;
}

void LrCheck::take_right(const RightMatch& match) {
  right_ = match;
  have_right_ = true;
  if (have_left_) finish_column();
}

void LrCheck::take_left(const LeftMatch& match) {
  left_ = match;
  have_left_ = true;
  if (have_right_) finish_column();
}

void LrCheck::finish_column() {
  have_right_ = false;
  have_left_ = false;
  const Disparity checked{check_.step(left_.disparity, left_.left_valid, right_.disparity)};
  if (columns_to_skip_ > 0) {
    --columns_to_skip_;
    return;
  }
  ++(checked.value == kernels::kInvalidDisparity ? stats_.invalid : stats_.answered);
  disparities_out->push(checked);
}

}  // namespace stereotlm::fpga
