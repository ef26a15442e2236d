#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/fast/sdram_parts.h"
#include "models/fpga/placement.h"

namespace stereotlm::fpga {

// Numbers the places of a frame. A place is a column of the matcher, in the drain too. From places with the
// same number on the same follows, up to the end of a group of four columns: the same slots are empty, the
// same parts of striped buffers hold the rows, the rows of sdram lie alike, and the frame is in the same
// phase (MatchControl::phase()).
class FramePlaces {
 public:
  // `ahead`: the slots of so many columns can have an effect before a group ends. `behind`: words of so many
  // columns can wait in the result queue; 0 if all of them go to one bank that is not of sdram. `placements`,
  // `sdram`: of the frame.
  FramePlaces(const CoreConfig& config, std::uint64_t ahead, std::uint64_t behind,
              const Placements& placements, const std::vector<SdramPart>& sdram);

  struct Place {
    std::uint64_t number = 0;
    std::uint64_t end = 0;  // the columns before this one have the number too
  };
  Place at(std::uint64_t column) const;

 private:
  struct Run {
    std::uint64_t first;
    std::uint64_t number;
  };

  std::vector<Run> runs_;         // of columns with the same number
  std::uint64_t end_;             // of the drain
  mutable std::size_t last_ = 0;  // the run that was asked for last
};

}  // namespace stereotlm::fpga
