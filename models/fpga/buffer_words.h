#pragma once

#include <cstdint>

#include "models/kernels/words.h"

namespace stereotlm::fpga {

// Byte addresses in the buffers of a frame, relative to the first byte of the buffer (contract section 1).
//
// The entry of a pixel in a look-up table. Pixels are counted row by row.
constexpr std::uint64_t entry_offset(std::uint64_t pixel) { return 4 * pixel; }
// The word of a picture that holds a pixel.
constexpr std::uint64_t pixel_word_offset(std::uint64_t pixel) { return pixel / kernels::kPixelsPerWord * 4; }
// A word of the disparities. Words are counted row by row.
constexpr std::uint64_t result_word_offset(std::uint64_t place) { return 4 * place; }

}  // namespace stereotlm::fpga
