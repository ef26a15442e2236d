#include "models/fpga/census.h"

#include "models/fpga/frame_geometry.h"

namespace stereotlm::fpga {

Census::Census(const sc_core::sc_module_name& name, const CoreConfig& config)
    : sc_module(name),
      filter_half_(config.filter ? config.filter->half() : 0),
      first_row_(FrameGeometry(config).first_row - filter_half_),
      census_(config.width, config.height, FrameGeometry(config).slots_per_column, config.rows, config.cost) {
  start_frame();
}

void Census::start_frame() {
  census_.start_frame(first_row_);
  columns_to_skip_ = filter_half_;
}

void Census::take(const PixelColumn& column) {
  ++stats_.columns;
  if (columns_to_skip_ > 0) {
    --columns_to_skip_;
    columns_out->push(census_.output());
  } else {
    columns_out->push(census_.push(column));
  }
}

}  // namespace stereotlm::fpga
