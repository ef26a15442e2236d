#pragma once

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
               const std::optional<FilterKernel>& kernel, const Simd& simd = best_simd());

  // Begins a frame. The next pixel is the first new row of column 0 of a strip; `first_row` is that row of
  // the image, and may be negative.
  void start_frame(int first_row);
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
  void begin_column();
  void finish_column();
  void filter_wide(const float* columns);

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
