#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/kernels/filter_kernel.h"

namespace stereotlm::kernels {

// A pixel with the valid bit of its table entry.
struct MaskedPixel {
  std::uint8_t value = 0;
  bool valid = false;
};

// The rows of one column on their way to the matcher, top first.
struct PixelColumn {
  std::array<std::uint8_t, 32> values{};
  std::uint32_t valid = 0;  // bit k: that of row k
};

// The filter of contract 1.2 as the hardware runs it: pixels enter column by column, `rows_per_column` new
// rows of each (n of them for the column fetch, 1 for line buffers), columns 0..width-1 of a strip, then the
// next strip one row further down; the 2h rows above come from line memories. What leaves with column u are
// the pixels of column u - h, h rows further up. Edge pixels repeat; what enters for rows outside the image
// is ignored. Without a kernel a column leaves as it enters.
class ColumnFilter {
 public:
  // Throws std::invalid_argument if the kernel has problems.
  ColumnFilter(int width, int height, int rows_per_column, const std::optional<FilterKernel>& kernel);

  // Next comes the first row of column 0 of a strip whose first new row is `first_row` (may be negative).
  void start_frame(int first_row);
  // True if the column is complete: then output() is what leaves with it, `rows_per_column` rows.
  bool push(MaskedPixel pixel) {
    entered_.values[static_cast<std::size_t>(k_)] = pixel.value;
    entered_valid_[static_cast<std::size_t>(k_)] = pixel.valid;
    if (++k_ < rows_per_column_) return false;
    k_ = 0;
    finish_column();
    return true;
  }
  const PixelColumn& output() const { return output_; }

 private:
  static constexpr int kRing = 32;         // columns kept, at least the kernel's 31
  static constexpr int kColumnRoom = 112;  // 2h + n <= 61 rows, and what vector loads read beyond
  struct Column {
    std::array<float, kColumnRoom> values{};
    std::uint64_t valid = 0;  // bit e: that of values[e]
  };

  void finish_column();
  void enter(Column& column) const;
  void leave();
  void filter_wide(const float* const* taps);

  int width_;
  int height_;
  int rows_per_column_;
  std::optional<FilterKernel> kernel_;
  int half_ = 0;
  bool wide_ = false;           // a sum may leave 24 bits, in which a float is exact
  std::vector<float> weights_;  // column by column

  std::vector<float> line_values_;         // line memories: 2h rows per image column
  std::vector<std::uint64_t> line_valid_;  // the ninth bit of their words: bit e per row
  std::array<Column, kRing> ring_{};
  std::uint64_t column_count_ = 0;
  int column_ = 0;     // of the image, of the pixel that enters next
  int k_ = 0;          // row within the column, of the pixel that enters next
  int first_row_ = 0;  // row of the image at k = 0
  PixelColumn entered_;
  std::array<bool, 32> entered_valid_{};
  PixelColumn output_;
};

}  // namespace stereotlm::kernels
