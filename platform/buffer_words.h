#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "models/fpga/register_map.h"
#include "models/words_by_range.h"
#include "platform/board_config.h"

namespace stereotlm::platform {

// The buffers of a board as registers and descriptors name them: bits 31..26 bank, 25..0 first word.
struct BufferWords {
  std::vector<std::uint32_t> left_images;
  std::vector<std::uint32_t> right_images;
  std::vector<std::uint32_t> disparities;
  std::optional<std::uint32_t> left_lut;
  std::optional<std::uint32_t> right_lut;
};

// Throws as layout_buffers() does.
BufferWords buffer_words(const BoardConfig& board);

// The addresses of the buffers on the local bus, in the order of buffers() in board_rules.h. Throws as layout_buffers()
// does.
std::vector<AddressRange> buffer_ranges(const BoardConfig& board);

}  // namespace stereotlm::platform
