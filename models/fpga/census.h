#pragma once

#include <cstdint>
#include <systemc>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/kernels/census.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The census transform of one side with its line memories (contract 7.6), between the filter and the matcher:
// takes filtered columns, and passes on columns of census bits.
class Census : public sc_core::sc_module {
 public:
  struct Stats {
    std::uint64_t columns = 0;
  };

  StreamOut<PixelColumn> columns_out{"columns_out"};

 private:
  void take(const PixelColumn& column);

 public:
  StreamIn<PixelColumn, Census, &Census::take> columns_in{"columns_in", this};

  // The cost of `config` must be kCensus.
  Census(const sc_core::sc_module_name& name, const CoreConfig& config);

  void start_frame();
  const Stats& stats() const { return stats_; }

 private:
  int filter_half_;
  int first_row_;  // image row of the first row that leaves the filter
  kernels::CensusColumns census_;
  int columns_to_skip_ = 0;  // columns that still come before the first output of the filter
  Stats stats_;
};

}  // namespace stereotlm::fpga
