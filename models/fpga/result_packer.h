#pragma once

#include <cstdint>
#include <systemc>

#include "models/fpga/beats.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Packs four disparities to a word, the lowest column in the lowest byte (contract 1.5).
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

  explicit ResultPacker(const sc_core::sc_module_name& name) : sc_module(name) {}

  void start_frame();
  // Adds the counts of a frame whose data did not pass through this stage.
  void count(const Stats& frame) { stats_.words += frame.words; }
  const Stats& stats() const { return stats_; }

 private:
  std::size_t next_ = 0;  // position in the word
  std::uint32_t word_ = 0;
  Stats stats_;
};

}  // namespace stereotlm::fpga
