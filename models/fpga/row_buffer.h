#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <systemc>
#include <vector>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The line memories of the `line_buffer` fetch for one side. They keep the last n-1 rows of filtered pixels,
// or of their census bits, so that each pixel completes a column of n. The memories are not cleared between
// frames.
class RowBuffer : public sc_core::sc_module {
 public:
  StreamOut<PixelColumn> columns_out{"columns_out"};  // the last n rows of each column

 private:
  void take(const PixelColumn& pixel) {
    const std::size_t older_bytes = newest_row_ * pixel_bytes_;
    std::uint8_t* const values = values_.data() + column_ * (older_bytes + pixel_bytes_);
    std::copy_n(values + pixel_bytes_, older_bytes, values);
    std::copy_n(pixel.values, pixel_bytes_, values + older_bytes);
    std::uint64_t& valid = valid_[column_];
    valid = valid >> 1U | (pixel.valid & 1U) << newest_row_;
    column_ = column_ + 1 == valid_.size() ? 0 : column_ + 1;
    columns_out->push({values, valid});
  }

 public:
  StreamIn<PixelColumn, RowBuffer, &RowBuffer::take> columns_in{"columns_in", this};  // one row

  // The configuration has no problems.
  RowBuffer(const sc_core::sc_module_name& name, const CoreConfig& config)
      : sc_module(name),
        newest_row_(static_cast<std::size_t>(config.window - 1)),
        pixel_bytes_(static_cast<std::size_t>(config.cost.pixel_bytes())),
        values_(static_cast<std::size_t>(config.width * config.window) * pixel_bytes_),
        valid_(static_cast<std::size_t>(config.width)) {}

  void start_frame() { column_ = 0; }  // to be called before the first pixel of a frame

 private:
  std::size_t newest_row_;  // n - 1
  std::size_t pixel_bytes_;
  std::size_t column_ = 0;
  std::vector<std::uint8_t> values_;  // [image column]: the last n pixels, of pixel_bytes_ bytes each
  std::vector<std::uint64_t> valid_;  // [image column]: the valid bits of these pixels
};

}  // namespace stereotlm::fpga
