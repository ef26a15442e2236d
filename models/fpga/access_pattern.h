#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "models/fpga/frame_geometry.h"

namespace stereotlm::fpga {

// Computes, before a frame that works directly on memory, which accesses each slot of one side makes: none if
// the slot lies outside the image, else one for its table entry, and one for its pixel if the entry is valid.
// Neighbouring columns are uniform if they make the same accesses slot for slot: slot k of one as slot k of
// the other. Runs of uniform columns are found when the entries are set, so that queries are cheap.
class AccessPattern {
 public:
  // At first every entry is valid, as on a side without table.
  explicit AccessPattern(const FrameGeometry& geometry);

  // Takes the valid bits of width * height entries, row-major.
  void set_entries(const std::uint32_t* entries);

  bool entry_valid(int column, int row) const {
    const auto place = static_cast<std::size_t>(column);
    return (valid_row(row)[place / 64] >> place % 64 & 1U) != 0;
  }
  bool all_valid() const { return all_valid_; }
  // The end of the run of uniform columns that begins with `frame_column`: the next column with other
  // accesses, or the number of columns. Columns are counted over the whole frame, strip after strip.
  std::uint64_t uniform_until(std::uint64_t frame_column) const;

  // The number of slots with an invalid entry among the first `slots` slots of a frame.
  std::uint64_t invalid_before(std::uint64_t slots) const;
  // Whether this slot makes an access for its pixel.
  bool needs_pixel(std::uint64_t slot) const;

  // Numbers of slots of a frame that are empty, and that access their pixel.
  std::uint64_t empty_slots() const { return empty_slots_; }
  std::uint64_t pixel_accesses() const { return pixel_accesses_; }

 private:
  const std::uint64_t* valid_row(int row) const {
    return valid_.data() + static_cast<std::size_t>(row) * words_;
  }
  bool inside(int row) const { return row >= 0 && row < geometry_.height; }
  struct Place {
    int column;
    int row;
  };
  Place place_of(std::uint64_t slot) const;
  void set_all(std::uint64_t* row_bits) const;
  void find_changes();
  std::vector<std::uint64_t> valid_in_rows() const;
  void find_changes_of_strip(int strip, const std::vector<std::uint64_t>& valid_in_rows);
  void find_strips_with_changes();
  bool strip_begins_alike(int strip) const;

  FrameGeometry geometry_;
  std::size_t words_;                 // words of 64 bits for a row of the image
  std::vector<std::uint64_t> valid_;  // [row][word]
  bool all_valid_ = false;
  std::vector<std::uint64_t> changes_;  // [strip][word]: columns with other accesses than the column before
  std::vector<std::uint64_t> invalid_before_strip_;  // [strip]: slots with an invalid entry
  // [strip]: the first strip, from this one on, in which changes_ has a bit set; or the number of strips.
  std::vector<std::uint32_t> next_change_;
  std::uint64_t empty_slots_ = 0;
  std::uint64_t pixel_accesses_ = 0;
};

using AccessPatterns = std::array<AccessPattern, 2>;  // [side]

}  // namespace stereotlm::fpga
