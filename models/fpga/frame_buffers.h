#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace stereotlm::fpga {

// The buffers of a board, as the base registers and the bridge's descriptors name them: bits 31..26 bank,
// 25..0 first word. Lists are used in turn, frame by frame.
struct FrameBuffers {
  std::vector<std::uint32_t> left_images;
  std::vector<std::uint32_t> right_images;  // as many
  std::vector<std::uint32_t> disparities;
  std::optional<std::uint32_t> left_lut;  // nullopt: the side has no table
  std::optional<std::uint32_t> right_lut;
};

}  // namespace stereotlm::fpga
