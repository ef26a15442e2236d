#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/fast/sdram_parts.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/placement.h"

namespace stereotlm::fpga {

// Numbers the places of a frame by the accesses that follow: which slots are empty, which parts of striped
// buffers hold the rows, and which rows of sdram. A place is a column of the matcher, in the drain too. The
// columns are divided into areas. In a uniform area all columns are alike: a group of four columns sees the
// slots of one strip only, results of one strip only, and in each row of a buffer one row of sdram only.
// Around the ends of strips, and where rows of sdram end, each column has its own number.
class FrameAreas {
 public:
  // `columns`: whose slots can have an effect before a group of four columns ends, from its first one on.
  // `result_columns`: within so many columns the result queue writes all words that it held before.
  // `placements`, `sdram`: of the frame.
  FrameAreas(const CoreConfig& config, std::uint64_t columns, std::uint64_t result_columns,
             const Placements& placements, const std::vector<SdramPart>& sdram);

  // If two columns of uniform areas have the same number, the same accesses follow up to the end of the
  // shorter area. If two other columns have the same number, they follow up to the ends of their areas.
  std::uint64_t number_of(std::uint64_t column) const {
    const Area& area = area_of(column);
    return area.number << 32U | (area.is_uniform ? 0 : area.end - column);
  }
  static bool is_uniform_number(std::uint64_t number) { return static_cast<std::uint32_t>(number) == 0; }
  // The column with which the area ends: a group of four columns ends there too, or the frame.
  std::uint64_t end_of_area(std::uint64_t column) const { return area_of(column).end; }
  // The number of the area among all, in their order.
  std::size_t index_of(std::uint64_t column) const {
    return static_cast<std::size_t>(&area_of(column) - areas_.data());
  }
  // How many times the areas from number `first` up to number `next` are followed by areas that are alike.
  std::uint64_t repeats(std::size_t first, std::size_t next) const;

 private:
  struct Area {
    std::uint64_t first;
    std::uint64_t end;
    std::uint64_t number;
    bool is_uniform;
  };
  const Area& area_of(std::uint64_t column) const;

  std::vector<Area> areas_;
  mutable std::size_t last_ = 0;  // the area that was asked for last: most often it, or the next one, follows
};

}  // namespace stereotlm::fpga
