#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/frame_geometry.h"
#include "models/kernels/rectification_table.h"

namespace stereotlm::fpga {

// The accesses of the slots of one side, computed before a frame that works directly on memory. A slot
// outside the image makes none. Any other reads its table entry. It reads its pixel if the entry is valid,
// unless the word cache holds the pixel's word.
class AccessPattern {
 public:
  // At first every entry is its own source, as on a side without table.
  AccessPattern(const FrameGeometry& geometry, PixelCache cache);

  // Takes width * height entries, row-major. They must stay as long as entry() is called. Without them the
  // entries are the identity.
  void set_entries(const std::uint32_t* entries);
  std::uint32_t entry(int column, int row) const {
    if (entries_ == nullptr) return kernels::make_entry(column, row);
    return entries_[static_cast<std::size_t>(row) * static_cast<std::size_t>(geometry_.width) +
                    static_cast<std::size_t>(column)];
  }

  // Whether a slot for this pixel accesses the image, in any strip: each begins with an empty word cache.
  bool needs_pixel(int column, int row) const {
    const auto place = static_cast<std::size_t>(column);
    return (pixels_of_row(row)[place / 64] >> place % 64 & 1U) != 0;
  }
  // Whether every slot inside the image accesses it.
  bool needs_all_pixels() const { return needs_all_pixels_; }
  // Whether every pixel is its own source.
  bool is_identity() const { return is_identity_; }
  // Whether slots access their pixels: bit i for slot `slot` + i of the frame, for 64 slots. 0 beyond the
  // end of the frame. `slot` is at most 256 slots beyond it.
  std::uint64_t pixels_of_slots(std::uint64_t slot) const {
    if (slots_.empty()) set_slots();
    const std::uint64_t* const words = slots_.data() + slot / 64;
    const std::uint64_t shift = slot % 64;
    return shift == 0 ? words[0] : words[0] >> shift | words[1] << (64 - shift);
  }

  // Numbers of slots of a frame that lie inside the image, and that access their pixel: in a lane, and in
  // all.
  std::uint64_t table_accesses(int lane) const { return table_accesses_[static_cast<std::size_t>(lane)]; }
  std::uint64_t pixel_accesses(int lane) const { return pixel_accesses_[static_cast<std::size_t>(lane)]; }
  // [lane][row of the buffer]: how often the slots of a frame read the row of the table, and of the image.
  using RowAccesses = std::vector<std::vector<std::uint64_t>>;
  const RowAccesses& table_accesses_of_rows() const;
  const RowAccesses& pixel_accesses_of_rows() const;
  std::uint64_t table_accesses() const { return sum_of(table_accesses_); }
  std::uint64_t pixel_accesses() const { return sum_of(pixel_accesses_); }

 private:
  const std::uint64_t* pixels_of_row(int row) const {
    return pixels_.data() + static_cast<std::size_t>(row) * words_;
  }
  static std::uint64_t sum_of(const std::vector<std::uint64_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  }
  void set_all(std::uint64_t* row_bits) const;
  bool are_own_sources(int row, const std::uint32_t* entries) const;
  bool set_row(int row, const std::uint32_t* entries);
  bool set_row_cached(int row, const std::uint32_t* entries);
  void count();
  void set_slots() const;

  FrameGeometry geometry_;
  bool has_cache_;
  const std::uint32_t* entries_ = nullptr;
  std::size_t words_;                  // words of 64 bits for a row of the image
  std::vector<std::uint64_t> pixels_;  // [row][word]: pixels that are accessed
  std::vector<std::uint64_t> counts_;  // [row]: their number
  bool needs_all_pixels_ = false;
  bool is_identity_ = true;
  // These three are empty until the first query: few frames need them.
  mutable std::vector<std::uint64_t> slots_;   // bit i of the sequence: slot i accesses its pixel
  mutable RowAccesses entries_of_rows_;        // table_accesses_of_rows()
  mutable RowAccesses pixels_of_rows_;         // pixel_accesses_of_rows()
  std::vector<std::uint64_t> table_accesses_;  // [lane]
  std::vector<std::uint64_t> pixel_accesses_;  // [lane]
};

using AccessPatterns = std::array<AccessPattern, 2>;  // [side]

}  // namespace stereotlm::fpga
