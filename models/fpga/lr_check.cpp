#include "models/fpga/lr_check.h"

namespace stereotlm::fpga {

LrCheck::LrCheck(const sc_core::sc_module_name& name, const CoreConfig& config)
    : sc_module(name),
      geometry_(config),
      rows_(static_cast<std::size_t>(config.rows),
            Row{kernels::LrCheck(config.disparities, config.lr_tolerance)}) {}

void LrCheck::start_frame() {
  for (Row& row : rows_) {
    row.check.start_frame();
    row.have_right = false;
    row.have_left = false;
  }
  // A result leaves result_delay_columns columns after its own column. The filter and the window, which lie
  // before this stage, cause a part of that delay.
  columns_to_skip_ =
      geometry_.result_delay_columns - static_cast<std::uint64_t>(geometry_.half + geometry_.radius);
  column_ = 0;
  first_row_ = 0;
}

void LrCheck::take_right(const RightMatch& match) {
  Row& row = rows_[static_cast<std::size_t>(match.row)];
  row.right = match;
  row.have_right = true;
  if (row.have_left) finish_column(row);
}

void LrCheck::take_left(const LeftMatch& match) {
  Row& row = rows_[static_cast<std::size_t>(match.row)];
  row.left = match;
  row.have_left = true;
  if (row.have_right) finish_column(row);
}

void LrCheck::finish_column(Row& row) {
  row.have_right = false;
  row.have_left = false;
  const int index = row.left.row;
  const Disparity checked{index,
                          row.check.step(row.left.disparity, row.left.left_valid, row.right.disparity)};
  if (columns_to_skip_ == 0 && geometry_.is_inside(first_row_ + index)) disparities_out->push(checked);
  if (index + 1 == geometry_.rows) next_column();
}

void LrCheck::next_column() {
  if (columns_to_skip_ > 0) {
    --columns_to_skip_;
    return;
  }
  if (++column_ < geometry_.width) return;
  column_ = 0;
  first_row_ += geometry_.rows;
}

}  // namespace stereotlm::fpga
