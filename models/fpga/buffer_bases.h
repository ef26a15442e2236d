#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "models/fpga/core_ports.h"

namespace stereotlm::fpga {

// Bank and first word of each buffer of a board, as the base registers and the bridge's descriptors take
// them: bits 31..26 bank, 25..0 first word. The buffers of a list are used in turn, frame by frame.
struct BufferBases {
  std::vector<std::uint32_t> left_images;
  std::vector<std::uint32_t> right_images;  // as many as left_images
  std::vector<std::uint32_t> disparities;
  std::optional<std::uint32_t> left_lut;  // nullopt: the side has no table of its own
  std::optional<std::uint32_t> right_lut;
  bool has_joint_tables = false;  // left_lut is one table for both sides; right_lut is nullopt

  // The base registers of frame number `frame`.
  FrameBases of_frame(std::uint64_t frame) const {
    const auto in_turn = [frame](const std::vector<std::uint32_t>& list) {
      return list[frame % list.size()];
    };
    return {left_lut.value_or(0), right_lut.value_or(0), in_turn(left_images), in_turn(right_images),
            in_turn(disparities)};
  }
};

}  // namespace stereotlm::fpga
