#include "models/fpga/lr_check.h"

#include "models/kernels/words.h"

namespace stereotlm::fpga {

LrCheck::LrCheck(const sc_core::sc_module_name& name, const CoreConfig& config)
    : sc_module(name),
      geometry_(config),
      rows_(static_cast<std::size_t>(config.rows),
            Row{kernels::LrCheck(config.disparities, config.lr_tolerance)}) {}

void LrCheck::start_frame() {
  for (std::size_t index = 0; index < rows_.size(); ++index) {
    Row& row = rows_[index];
    row.check.start_frame();
    // A result leaves result_delay_columns columns after its own column. The filter and the window, which lie
    // before this stage, cause a part of that delay.
    row.columns_to_skip =
        geometry_.result_delay_columns - static_cast<std::uint64_t>(geometry_.half + geometry_.radius);
    row.column = 0;
    row.image_row = static_cast<int>(index);
    row.have_right = false;
    row.have_left = false;
  }
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
  const Disparity checked{row.left.row,
                          row.check.step(row.left.disparity, row.left.left_valid, row.right.disparity)};
  if (row.columns_to_skip > 0) {
    --row.columns_to_skip;
    return;
  }
  const bool is_inside = row.image_row < geometry_.height;
  if (++row.column == geometry_.width) {
    row.column = 0;
    row.image_row += geometry_.rows;
  }
  if (!is_inside) return;
  ++(checked.value == kernels::kInvalidDisparity ? stats_.invalid : stats_.answered);
  disparities_out->push(checked);
}

}  // namespace stereotlm::fpga
