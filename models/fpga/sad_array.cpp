#include "models/fpga/sad_array.h"

namespace stereotlm::fpga {

SadArray::SadArray(const sc_core::sc_module_name& name, const CoreConfig& config)
    : sc_module(name),
      geometry_(config),
      window_(config.window),
      disparities_(config.disparities),
      sums_(config.window, config.disparities) {}

void SadArray::start_frame() {
  sums_.start_frame();
  have_left_ = false;
  have_right_ = false;
  columns_before_window_ = geometry_.half + geometry_.radius;
  column_ = 0;
  row_ = -geometry_.lead_strips;
  left_valid_ = 0;
}

void SadArray::take_left(const PixelColumn& column) {
  left_ = column;
  have_left_ = true;
  if (have_right_) finish_column();
}

void SadArray::take_right(const PixelColumn& column) {
  right_ = column;
  have_right_ = true;
  if (have_left_) finish_column();
}

void SadArray::finish_column() {
  have_left_ = false;
  have_right_ = false;
  sums_.push_column(left_.values.data(), right_.values.data());
  left_valid_ = left_valid_ << 1U | (left_.valid >> geometry_.radius & 1U);
  ++stats_.columns;
  stats_.absolute_differences +=
      static_cast<std::uint64_t>(window_) * static_cast<std::uint64_t>(disparities_);
  if (columns_before_window_ > 0) {
    --columns_before_window_;
    return;
  }
  WindowSums window;
  window.sums = sums_.window_sums();
  window.lanes = sums_.lanes();
  window.candidates =
      kernels::candidate_count(column_, row_, geometry_.width, geometry_.height, window_, disparities_);
  window.left_valid = (left_valid_ >> geometry_.radius & 1U) != 0;
  stats_.candidates += static_cast<std::uint64_t>(window.candidates);
  if (++column_ == geometry_.width) {
    column_ = 0;
    ++row_;
  }
  chain_out->push(window);
  tree_out->push(window);
}

}  // namespace stereotlm::fpga
