#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/kernels/column_neighbourhood.h"
#include "models/kernels/filter_kernel.h"
#include "models/kernels/pixel_column.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// Filters the pixels of a frame (contract 1.2) in the order in which the hardware fetches them; used by
// fpga::LogFilter. Pixels enter column by column, see ColumnNeighbourhood. A column has `rows_per_column` new
// rows: n + R - 1 for the column fetch, 1 for line buffers. When column u enters, the filtered pixels of
// column u - h leave, h rows further up (h: half width of the kernel). Without a kernel a column leaves as
// it enters.
class ColumnFilter {
 public:
  // The kernel has no problems.
  ColumnFilter(int width, int height, int rows_per_column, int rows_per_strip,
               const std::optional<FilterKernel>& kernel, const Simd& simd = best_simd())
      : simd_(simd),
        rows_per_column_(rows_per_column),
        kernel_(kernel),
        pixels_(width, height, rows_per_column, rows_per_strip, kernel ? kernel->half() : 0),
        output_(static_cast<std::size_t>(padded_rows(rows_per_column))) {
    if (kernel_) {
      std::int64_t positive = 0;
      for (int column = 0; column < kernel_->size; ++column) {
        for (int row = 0; row < kernel_->size; ++row) {
          const int weight = kernel_->weight(column, row);
          weights_.push_back(static_cast<float>(weight));
          positive += std::max(weight, 0);
        }
      }
      // The weights sum to 0, so that every partial sum lies in -255 * positive .. 255 * positive.
      wide_ = positive * 255 > (1 << 24);
    }
    start_frame(0);
  }

  // Begins a frame. The next pixel is the first new row of column 0 of a strip; `first_row` is that row of
  // the image, and may be negative.
  void start_frame(int first_row) {
    pixels_.start_frame(first_row);
    k_ = rows_per_column_;
  }
  // Returns true if the pixel completes its column. output() then holds the `rows_per_column` rows that leave
  // with it.
  bool push(MaskedPixel pixel) {
    if (k_ == rows_per_column_) begin_column();
    const auto k = static_cast<std::size_t>(k_);
    if (entered_ != nullptr) {
      entered_[k] = static_cast<float>(pixel.value);
    } else {
      output_[k] = pixel.value;
    }
    entered_valid_ |= std::uint64_t{pixel.valid} << k;
    if (++k_ < rows_per_column_) return false;
    finish_column();
    return true;
  }
  // The last column that has left; valid until the next push().
  PixelColumn output() const { return {output_.data(), output_valid_}; }

 private:
  void begin_column() {
    k_ = 0;
    entered_valid_ = 0;
    if (kernel_) entered_ = pixels_.begin_column();
  }
  void finish_column() {
    if (!kernel_) {
      output_valid_ = entered_valid_;
      return;
    }
    if (!pixels_.finish_column(entered_valid_)) return;
    const float* const columns = pixels_.columns();
    output_valid_ = pixels_.valid();
    if (wide_) {
      filter_wide(columns);
    } else {
      simd_.filter_column(columns, pixels_.stride(), weights_.data(), kernel_->size, rows_per_column_,
                          kernel_->shift, output_.data());
    }
  }
  void filter_wide(const float* columns) {
    for (int k = 0; k < rows_per_column_; ++k) {
      std::int64_t sum = 0;
      for (int i = 0; i < kernel_->size; ++i) {
        const float* const column = columns + pixels_.stride() * i;
        for (int j = 0; j < kernel_->size; ++j) {
          sum += static_cast<std::int64_t>(column[k + j]) * kernel_->weight(i, j);
        }
      }
      // An arithmetic shift is the floor of the quotient.
      const std::int64_t level = 128 + (sum >> kernel_->shift);
      output_[static_cast<std::size_t>(k)] =
          static_cast<std::uint8_t>(std::clamp<std::int64_t>(level, 0, 255));
    }
  }

  const Simd& simd_;
  int rows_per_column_;
  std::optional<FilterKernel> kernel_;
  bool wide_ = false;           // a sum may exceed 24 bits, up to which a float is exact
  std::vector<float> weights_;  // column by column
  ColumnNeighbourhood<float> pixels_;

  int k_ = 0;                 // number of rows of the column that have entered
  float* entered_ = nullptr;  // where the rows of that column are stored; null without kernel
  std::uint64_t entered_valid_ = 0;
  std::vector<std::uint8_t> output_;
  std::uint64_t output_valid_ = 0;
};

}  // namespace stereotlm::kernels
