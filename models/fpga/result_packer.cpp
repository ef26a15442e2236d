#include "models/fpga/result_packer.h"

#include "models/kernels/words.h"

namespace stereotlm::fpga {

ResultPacker::ResultPacker(const sc_core::sc_module_name& name, const CoreConfig& config)
    : sc_module(name),
      words_of_row_(static_cast<std::uint64_t>(config.width / kernels::kPixelsPerWord)),
      rows_(static_cast<std::size_t>(config.rows)) {}

void ResultPacker::start_frame() {
  for (std::size_t row = 0; row < rows_.size(); ++row) rows_[row] = {0, 0, row * words_of_row_};
}

void ResultPacker::take(const Disparity& disparity) {
  Row& row = rows_[static_cast<std::size_t>(disparity.row)];
  row.word = kernels::insert_pixel(row.word, row.next, disparity.value);
  if (++row.next < kernels::kPixelsPerWord) return;
  row.next = 0;
  ++stats_.words;
  words_out->push({row.word, row.place});
  // The other rows of the strip lie between the last word of the row and its first word in the next strip.
  if (++row.place % words_of_row_ == 0) row.place += (rows_.size() - 1) * words_of_row_;
}

}  // namespace stereotlm::fpga
