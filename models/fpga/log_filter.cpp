#include "models/fpga/log_filter.h"

namespace stereotlm::fpga {

LogFilter::LogFilter(const sc_core::sc_module_name& name, const CoreConfig& config)
    : sc_module(name),
      first_row_(FrameGeometry(config).first_row),
      filter_(config.width, config.height, FrameGeometry(config).slots_per_column, config.rows,
              config.filter) {}

void LogFilter::take(const MaskedPixel& pixel) {
  ++stats_.pixels;
  if (!filter_.push(pixel)) return;
  ++stats_.columns;
  columns_out->push(filter_.output());
}

}  // namespace stereotlm::fpga
