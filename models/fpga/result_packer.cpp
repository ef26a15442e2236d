#include "models/fpga/result_packer.h"

#include "models/kernels/words.h"

namespace stereotlm::fpga {

void ResultPacker::start_frame() {
  next_ = 0;
  word_ = 0;
}

void ResultPacker::take(const Disparity& disparity) {
  word_ = kernels::insert_pixel(word_, next_, disparity.value);
  if (++next_ < kernels::kPixelsPerWord) return;
  next_ = 0;
  ++stats_.words;
  words_out->push({word_});
}

}  // namespace stereotlm::fpga
