#pragma once

#include <array>
#include <cstdint>

#include "models/kernels/matching_cost.h"

namespace stereotlm::kernels {

// A pixel with the valid bit of its table entry.
struct MaskedPixel {
  std::uint8_t value = 0;
  bool valid = false;
};

// The largest number of rows of a column: n + R - 1.
inline constexpr int kMostRows = 46;

// The rows of one column on their way to the matcher, top first. A row has one byte, the grey level of its
// pixel, or MatchingCost::pixel_bytes() bytes of census bits.
struct PixelColumn {
  static constexpr std::size_t kMostBytes = (kMostRows * kMostPixelBytes + 7) / 8 * 8;  // whole blocks
  std::array<std::uint8_t, kMostBytes> values{};
  std::uint64_t valid = 0;  // bit k: whether row k is valid
};

}  // namespace stereotlm::kernels
