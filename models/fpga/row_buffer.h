#pragma once

#include <cstdint>
#include <systemc>
#include <vector>

#include "models/fpga/beats.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The line memories of the `line_buffer` fetch for one side. They keep the last n-1 rows of filtered pixels,
// or of their census bits, so that each pixel completes a column of n. The memories are not cleared between
// frames.
class RowBuffer : public sc_core::sc_module {
 public:
  StreamOut<PixelColumn> columns_out{"columns_out"};

 private:
  void take(const PixelColumn& pixel);

 public:
  StreamIn<PixelColumn, RowBuffer, &RowBuffer::take> columns_in{"columns_in", this};

  // `width`: pixels of a row of the image; `window`: n; `pixel_bytes`: bytes of a pixel (PixelColumn). Throws
  // std::invalid_argument outside kWidthRule, kWindowRule and 1..kMostPixelBytes.
  RowBuffer(const sc_core::sc_module_name& name, int width, int window, int pixel_bytes);

  void start_frame() { column_ = 0; }

 private:
  std::size_t newest_row_;  // n - 1
  std::size_t pixel_bytes_;
  std::size_t column_ = 0;
  std::vector<std::uint8_t> values_;  // [image column]: the last n pixels, of pixel_bytes_ bytes each
  std::vector<std::uint64_t> valid_;  // [image column]: the valid bits of these pixels
};

}  // namespace stereotlm::fpga
