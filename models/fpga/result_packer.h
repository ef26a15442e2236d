#pragma once

#include <cstdint>
#include <systemc>
#include <vector>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/kernels/words.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// Packs four disparities of a row to a word, the lowest column in the lowest byte (contract 1.5).
class ResultPacker : public sc_core::sc_module {
 public:
  StreamOut<ResultWord> words_out{"words_out"};  // with their places in the disparity buffer

 private:
  void take(const Disparity& disparity) {
    Row& row = rows_[static_cast<std::size_t>(disparity.row)];
    row.word = kernels::insert_pixel(row.word, row.next, disparity.value);
    if (++row.next < kernels::kPixelsPerWord) return;
    row.next = 0;
    ++words_;
    words_out->push({row.word, row.place});
    // The other rows of the strip lie between the last word of the row and its first word in the next strip.
    if (++row.place % words_of_row_ == 0) row.place += (rows_.size() - 1) * words_of_row_;
  }

 public:
  // Of each column the rows of its strip that lie inside the image.
  StreamIn<Disparity, ResultPacker, &ResultPacker::take> disparities_in{"disparities_in", this};

  // The configuration has no problems.
  ResultPacker(const sc_core::sc_module_name& name, const CoreConfig& config)
      : sc_module(name),
        words_of_row_(static_cast<std::uint64_t>(config.width / kernels::kPixelsPerWord)),
        rows_(static_cast<std::size_t>(config.rows)) {}

  void start_frame() {  // to be called before the first disparity of a frame
    for (std::size_t row = 0; row < rows_.size(); ++row) rows_[row] = {0, 0, row * words_of_row_};
  }
  // The number of words, over all frames.
  std::uint64_t words() const { return words_; }

 private:
  struct Row {
    std::size_t next = 0;  // position in the word
    std::uint32_t word = 0;
    std::uint64_t place = 0;  // of the word in the disparity buffer
  };

  std::uint64_t words_of_row_;
  std::vector<Row> rows_;  // [row] of the R rows of a strip
  std::uint64_t words_ = 0;
};

}  // namespace stereotlm::fpga
