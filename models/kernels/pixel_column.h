#pragma once

#include <cstdint>

namespace stereotlm::kernels {

// A pixel with the valid bit of its table entry.
struct MaskedPixel {
  std::uint8_t value = 0;  // grey level; 0 unless valid
  bool valid = false;      // the pixel has a source
};

// The largest number of rows of a column: n + R - 1.
inline constexpr int kMostRows = 46;

// The rows of one column on their way to the matcher, top first. A row has one byte, the grey level of its
// pixel, or MatchingCost::pixel_bytes() bytes of census bits.
struct PixelColumn {
  const std::uint8_t* values = nullptr;  // unchanged until the stage that holds them gets its next pixel
  std::uint64_t valid = 0;               // bit k: whether row k is valid
};

}  // namespace stereotlm::kernels
