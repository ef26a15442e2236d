#include "models/fpga/cost_array.h"

namespace stereotlm::fpga {

CostArray::CostArray(const sc_core::sc_module_name& name, const CoreConfig& config)
    : sc_module(name),
      geometry_(config),
      window_(config.window),
      disparities_(config.disparities),
      pixel_bytes_(config.cost.pixel_bytes()) {
  for (int row = 0; row < config.rows; ++row) {
    Row& windows = rows_.emplace_back(Row{kernels::CostColumns(window_, disparities_, config.cost), {}});
    if (kernels::ColumnScorer::is_needed(window_, config.cost))
      windows.scorer.emplace(window_, disparities_, config.cost);
  }
}

void CostArray::start_frame() {
  for (Row& row : rows_) {
    row.sums.start_frame();
    if (row.scorer) row.scorer->start_frame();
    row.left_valid = 0;
  }
  columns_before_window_ = geometry_.half + geometry_.radius;
  column_ = 0;
  first_row_ = -geometry_.lead_strips * geometry_.rows;
}

void CostArray::take_right(const PixelColumn& column) {
  const bool has_windows = columns_before_window_ == 0;
  for (int index = 0; index < geometry_.rows; ++index) {
    Row& row = rows_[static_cast<std::size_t>(index)];
    const std::uint8_t* const left = left_.values + index * pixel_bytes_;
    const std::uint8_t* const right = column.values + index * pixel_bytes_;
    row.sums.push_column(left, right);
    if (row.scorer) row.scorer->push_column(left, right, row.sums.window_sums());
    row.left_valid = row.left_valid << 1U | (left_.valid >> (index + geometry_.radius) & 1U);
    if (has_windows) pass_on(index, row);
  }
  if (!has_windows) {
    --columns_before_window_;
    return;
  }
  if (++column_ == geometry_.width) {
    column_ = 0;
    first_row_ += geometry_.rows;
  }
}

void CostArray::pass_on(int index, const Row& row) {
  WindowSums window;
  window.row = index;
  window.sums = row.sums.window_sums();
  window.lanes = row.sums.lanes();
  if (row.scorer) window.scores = &row.scorer->scores();
  window.candidates = kernels::candidate_count(column_, first_row_ + index, geometry_.width, geometry_.height,
                                               window_, disparities_);
  window.left_valid = (row.left_valid >> geometry_.radius & 1U) != 0;
  chain_out->push(window);
  tree_out->push(window);
}

}  // namespace stereotlm::fpga
