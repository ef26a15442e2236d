#include "models/fpga/row_buffer.h"

#include <algorithm>

namespace stereotlm::fpga {

RowBuffer::RowBuffer(const sc_core::sc_module_name& name, int width, int window)
    : sc_module(name),
      newest_row_(static_cast<std::size_t>(window - 1)),
      columns_(static_cast<std::size_t>(width)) {}

void RowBuffer::take(const PixelColumn& pixel) {
  PixelColumn& column = columns_[column_];
  std::copy_n(column.values.begin() + 1, newest_row_, column.values.begin());
  column.values[newest_row_] = pixel.values[0];
  column.valid = column.valid >> 1U | (pixel.valid & 1U) << newest_row_;
  column_ = column_ + 1 == columns_.size() ? 0 : column_ + 1;
  ++stats_.columns;
  columns_out->push(column);
}

}  // namespace stereotlm::fpga
