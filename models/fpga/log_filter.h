#pragma once

#include <systemc>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/kernels/column_filter.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The filter of one side with its line memories (paper section 2.4; contract 1.2): takes pixels in the order
// of the slots, and passes on filtered columns. Without a filter it only collects the columns.
class LogFilter : public sc_core::sc_module {
 public:
  StreamOut<PixelColumn> columns_out{"columns_out"};  // filtered columns, top first

 private:
  void take(const MaskedPixel& pixel) {
    if (filter_.push(pixel)) columns_out->push(filter_.output());
  }

 public:
  StreamIn<MaskedPixel, LogFilter, &LogFilter::take> pixels_in{"pixels_in", this};  // in slot order

  // The configuration has no problems.
  LogFilter(const sc_core::sc_module_name& name, const CoreConfig& config)
      : sc_module(name),
        first_row_(FrameGeometry(config).first_row),
        filter_(config.width, config.height, FrameGeometry(config).slots_per_column, config.rows,
                config.filter) {}

  void start_frame() { filter_.start_frame(first_row_); }  // to be called before the first slot of a frame

 private:
  int first_row_;
  kernels::ColumnFilter filter_;
};

}  // namespace stereotlm::fpga
