#pragma once

#include <cstdint>
#include <systemc>
#include <vector>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Packs four disparities of a row to a word, the lowest column in the lowest byte (contract 1.5).
class ResultPacker : public sc_core::sc_module {
 public:
  struct Stats {
    std::uint64_t words = 0;
  };

  StreamOut<ResultWord> words_out{"words_out"};

 private:
  void take(const Disparity& disparity);

 public:
  StreamIn<Disparity, ResultPacker, &ResultPacker::take> disparities_in{"disparities_in", this};

  ResultPacker(const sc_core::sc_module_name& name, const CoreConfig& config);

  void start_frame();
  const Stats& stats() const { return stats_; }

 private:
  struct Row {
    std::size_t next = 0;  // position in the word
    std::uint32_t word = 0;
    std::uint64_t place = 0;  // of the word in the disparity buffer
  };

  std::uint64_t words_of_row_;
  std::vector<Row> rows_;  // [row] of the R rows of a strip
  Stats stats_;
};

}  // namespace stereotlm::fpga
