#include "models/fpga/row_buffer.h"

#include <algorithm>

#include "models/fpga/core_config.h"
#include "models/kernels/limits.h"
#include "models/kernels/matching_cost.h"

namespace stereotlm::fpga {
namespace {

constexpr kernels::IntegerRule kPixelBytesRule{1, kernels::kMostPixelBytes};

}  // namespace

RowBuffer::RowBuffer(const sc_core::sc_module_name& name, int width, int window, int pixel_bytes)
    : sc_module(name),
      newest_row_(static_cast<std::size_t>(kernels::kWindowRule.required("window", window) - 1)),
      pixel_bytes_(static_cast<std::size_t>(kPixelBytesRule.required("pixel_bytes", pixel_bytes))),
      values_(static_cast<std::size_t>(kWidthRule.required("width", width)) *
              static_cast<std::size_t>(window) * pixel_bytes_),
      valid_(static_cast<std::size_t>(width)) {}

void RowBuffer::take(const PixelColumn& pixel) {
  const std::size_t older_bytes = newest_row_ * pixel_bytes_;
  std::uint8_t* const values = values_.data() + column_ * (older_bytes + pixel_bytes_);
  std::copy_n(values + pixel_bytes_, older_bytes, values);
  std::copy_n(pixel.values, pixel_bytes_, values + older_bytes);
  std::uint64_t& valid = valid_[column_];
  valid = valid >> 1U | (pixel.valid & 1U) << newest_row_;
  column_ = column_ + 1 == valid_.size() ? 0 : column_ + 1;
  columns_out->push({values, valid});
}

}  // namespace stereotlm::fpga
