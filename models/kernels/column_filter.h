#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/kernels/filter_kernel.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {

// A pixel with the valid bit of its table entry.
struct MaskedPixel {
  std::uint8_t value = 0;
  bool valid = false;
};

// The largest number of rows of a column.
inline constexpr int kMostRows = 32;

// The rows of one column on their way to the matcher, top first.
struct PixelColumn {
  std::array<std::uint8_t, kMostRows> values{};
  std::uint32_t valid = 0;  // bit k: whether row k is valid
};

// Filters the pixels of a frame (contract 1.2) in the order in which the hardware fetches them; used by
// fpga::LogFilter. Pixels enter column by column: columns 0..width-1 of a strip, then those of the next
// strip, one row further down. A column has `rows_per_column` new rows: n for the column fetch, 1 for line
// buffers. The 2h rows above the new ones come from line memories (h: half width of the kernel). When column
// u enters, the filtered pixels of column u - h leave, h rows further up. Edge pixels repeat, and pixels of
// rows outside the image are ignored. Without a kernel a column leaves as it enters.
class ColumnFilter {
 public:
  // Throws std::invalid_argument if the kernel has problems, the image has no pixels, or `rows_per_column` is
  // outside 1..kMostRows.
  ColumnFilter(int width, int height, int rows_per_column, const std::optional<FilterKernel>& kernel,
               const Simd& simd = best_simd());

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
      output_.values[k] = pixel.value;
    }
    entered_valid_ |= std::uint64_t{pixel.valid} << k;
    if (++k_ < rows_per_column_) return false;
    finish_column();
    return true;
  }
  // The last column that has left; valid until the next push().
  const PixelColumn& output() const { return output_; }

 private:
  void begin_column();
  void finish_column();
  void repeat_edges();
  void leave();
  const float* columns_around(int centre, std::size_t centre_position);
  void filter_wide(const float* columns);
  float* column_at(std::size_t position) { return columns_.data() + position * stride_; }

  const ColumnSimd& simd_;
  int width_;
  int height_;
  int rows_per_column_;
  std::optional<FilterKernel> kernel_;
  int half_ = 0;
  bool wide_ = false;           // a sum may exceed 24 bits, up to which a float is exact
  std::vector<float> weights_;  // column by column

  // Line memories: 2h rows per image column, padded to whole blocks, and the valid bits of these rows (bit e:
  // row e).
  std::size_t line_stride_ = 0;
  std::vector<float> line_values_;
  std::vector<std::uint64_t> line_valid_;
  // The last columns, of 2h + rows_per_column rows each; the newest is at position_. When the memory is full,
  // the last columns move to its beginning.
  std::size_t stride_ = 0;
  std::vector<float> columns_;
  std::vector<std::uint64_t> columns_valid_;
  std::vector<float> repeated_;  // copies of the columns around a column near the left or right edge
  std::size_t position_ = 0;
  std::uint64_t column_count_ = 0;  // columns completed since the start of the frame

  int column_ = 0;            // image column of the pixel that entered last
  int k_ = 0;                 // number of rows of that column that have entered
  int first_row_ = 0;         // image row at k = 0
  float* entered_ = nullptr;  // where the rows of that column are stored; null without kernel
  std::uint64_t entered_valid_ = 0;
  PixelColumn output_;
};

}  // namespace stereotlm::kernels
