#pragma once

#include <systemc>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/kernels/census.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The census transform of one side with its line memories (contract 7.6), between the filter and the matcher:
// takes filtered columns, and passes on columns of census bits.
class Census : public sc_core::sc_module {
 public:
  StreamOut<PixelColumn> columns_out{"columns_out"};  // census bits

 private:
  void take(const PixelColumn& column) {
    const bool is_skipped = columns_to_skip_ > 0;
    if (is_skipped) --columns_to_skip_;
    columns_out->push(is_skipped ? census_.output() : census_.push(column));
  }

 public:
  StreamIn<PixelColumn, Census, &Census::take> columns_in{"columns_in", this};  // filtered pixels

  // The cost of `config` must be kCensus.
  Census(const sc_core::sc_module_name& name, const CoreConfig& config)
      : sc_module(name),
        filter_half_(config.filter ? config.filter->half() : 0),
        first_row_(FrameGeometry(config).first_row - filter_half_),
        census_(config.width, config.height, FrameGeometry(config).slots_per_column, config.rows,
                config.cost) {
    start_frame();
  }

  void start_frame() {  // to be called before the first column of a frame
    census_.start_frame(first_row_);
    columns_to_skip_ = filter_half_;
  }

 private:
  int filter_half_;
  int first_row_;  // image row of the first row that leaves the filter
  kernels::CensusColumns census_;
  int columns_to_skip_ = 0;  // columns that still come before the first output of the filter
};

}  // namespace stereotlm::fpga
