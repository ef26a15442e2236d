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

// The most rows of a column.
inline constexpr int kMostRows = 32;

// The rows of one column on their way to the matcher, top first.
struct PixelColumn {
  std::array<std::uint8_t, kMostRows> values{};
  std::uint32_t valid = 0;  // bit k: that of row k
};

// The filter of contract 1.2 as the hardware runs it: pixels enter column by column, `rows_per_column` new
// rows of each (n of them for the column fetch, 1 for line buffers), columns 0..width-1 of a strip, then the
// next strip one row further down; the 2h rows above come from line memories. What leaves with column u are
// the pixels of column u - h, h rows further up. Edge pixels repeat; what enters for rows outside the image
// is ignored. Without a kernel a column leaves as it enters.
class ColumnFilter {
 public:
  // Throws std::invalid_argument if the kernel has problems, the image has no pixels, or `rows_per_column` is
  // outside 1..kMostRows.
  ColumnFilter(int width, int height, int rows_per_column, const std::optional<FilterKernel>& kernel,
               const Simd& simd = best_simd());

  // Next comes the first row of column 0 of a strip whose first new row is `first_row` (may be negative).
  void start_frame(int first_row);
  // True if the column is complete: then output() is what leaves with it, `rows_per_column` rows.
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
  // Until the next push().
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
  bool wide_ = false;           // a sum may leave 24 bits, in which a float is exact
  std::vector<float> weights_;  // column by column

  // Line memories: per image column 2h rows, in whole blocks, and the ninth bit of their words: bit e for row
  // e.
  std::size_t line_stride_ = 0;
  std::vector<float> line_values_;
  std::vector<std::uint64_t> line_valid_;
  // The last columns, 2h + rows_per_column rows each, the newest at position_. At the end of the memory the
  // last ones move to its beginning.
  std::size_t stride_ = 0;
  std::vector<float> columns_;
  std::vector<std::uint64_t> columns_valid_;
  std::vector<float> repeated_;  // the columns around one near the left or right edge
  std::size_t position_ = 0;
  std::uint64_t column_count_ = 0;  // since the start of the frame, without the one that enters

  int column_ = 0;            // of the image, of the pixel that entered last
  int k_ = 0;                 // rows entered of the column
  int first_row_ = 0;         // row of the image at k = 0
  float* entered_ = nullptr;  // where they enter; null without kernel
  std::uint64_t entered_valid_ = 0;
  PixelColumn output_;
};

}  // namespace stereotlm::kernels
