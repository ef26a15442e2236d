#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include "models/fpga/frame_geometry.h"

namespace stereotlm::fpga {

// Numbers the places of a frame by the slots that follow. In most strips the same slots are empty, so that
// most places are alike. The columns of a frame are divided into areas. In a uniform area, a group of four
// columns sees no other slots than those of its strip. Outside, the next strips with other slots matter too.
class SlotWindows {
 public:
  // `columns`: whose slots can have an effect before a group of four columns ends, from its first one on.
  SlotWindows(const FrameGeometry& geometry, std::uint64_t columns)
      : width_(geometry.columns_per_strip()), columns_(columns) {
    std::vector<std::uint64_t> empty;  // [strip]: bit k is 1 if slot k of each column is empty
    for (int strip = 0; strip < geometry.strips; ++strip) {
      empty.push_back(0);
      for (int k = 0; k < geometry.slots_per_column; ++k)
        empty.back() |= std::uint64_t{!geometry.is_inside(geometry.first_row_of(strip) + k)} << k;
    }
    std::map<std::vector<std::uint64_t>, std::uint64_t> numbers;
    const auto number_of_strips = [&](std::size_t strip, std::size_t strips) {
      const auto first = empty.begin() + static_cast<std::ptrdiff_t>(strip);
      const auto last = first + static_cast<std::ptrdiff_t>(std::min(strips, empty.size() - strip));
      return numbers.try_emplace({first, last}, numbers.size()).first->second;
    };
    // A place outside a uniform area also determines the places after it, one of which may be uniform.
    const std::size_t strips_of_window = 2 * (columns + 4) / width_ + 2;
    for (std::size_t strip = 0; strip < empty.size(); ++strip) {
      strips_.push_back(
          {number_of_strips(strip, 1), number_of_strips(strip, strips_of_window), empty.size()});
    }
    for (std::size_t strip = strips_.size() - 1; strip-- > 0;) {
      const bool is_alike = empty[strip] == empty[strip + 1];
      strips_[strip].next_change = is_alike ? strips_[strip + 1].next_change : strip + 1;
    }
  }

  // The number of a column; columns are counted over all strips. If two columns of uniform areas have the
  // same number, the same slots follow up to the end of the shorter area. If two other columns have the same
  // number, the same slots follow up to the end of their areas, and the columns at these ends have the same
  // number.
  std::uint64_t number_of(std::uint64_t column) const {
    const Strip& strip = strips_[column / width_];
    return is_uniform(column) ? strip.number << 32U : strip.window << 32U | columns_to_change(column);
  }
  static bool is_uniform_number(std::uint64_t number) { return static_cast<std::uint32_t>(number) == 0; }
  // The last column with which a group of the area may end.
  std::uint64_t end_of_area(std::uint64_t column) const {
    if (is_uniform(column)) return column + columns_to_change(column) - columns_;
    for (std::uint64_t strip = strips_[column / width_].next_change; strip < strips_.size();
         strip = strips_[strip].next_change) {
      if (is_uniform(strip * width_)) return strip * width_ + 3;
    }
    return UINT64_MAX;
  }

 private:
  struct Strip {
    std::uint64_t number;       // of its slots
    std::uint64_t window;       // a number for its slots and those of the strips below
    std::uint64_t next_change;  // the first strip below with other slots, or the number of strips
  };

  bool is_uniform(std::uint64_t column) const { return columns_to_change(column) >= columns_ + 4; }
  std::uint64_t columns_to_change(std::uint64_t column) const {
    return strips_[column / width_].next_change * width_ - column;
  }

  std::uint64_t width_;
  std::uint64_t columns_;
  std::vector<Strip> strips_;
};

}  // namespace stereotlm::fpga
