#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"

namespace stereotlm::kernels {

// A table has one 32-bit entry per rectified pixel (contract 1.1): bit 31 valid, bits 26..16 source row, bits
// 10..0 source column, all other bits 0.
inline constexpr std::uint32_t kEntryValid = 0x8000'0000U;
inline constexpr std::uint32_t kEntryUnusedBits = 0x7800'F800U;

constexpr std::uint32_t make_entry(int column, int row) {  // valid, with this source
  return kEntryValid | static_cast<std::uint32_t>(row) << 16U | static_cast<std::uint32_t>(column);
}
// What the entry says: whether the pixel has a source, and where.
constexpr bool entry_is_valid(std::uint32_t entry) { return (entry & kEntryValid) != 0; }
constexpr int entry_row(std::uint32_t entry) { return static_cast<int>(entry >> 16U & 0x7FFU); }
constexpr int entry_column(std::uint32_t entry) { return static_cast<int>(entry & 0x7FFU); }

// The look-up table of one camera: entries row-major, width x height of the rectified image, which is also
// the size of the source.
struct RectificationTable {
  int width = 0;                       // pixels
  int height = 0;                      // pixels
  std::vector<std::uint32_t> entries;  // width * height
};

// Returns a table whose entry (x, y) is pixel (x + offset, y), or not valid if that is outside. Without
// offset every pixel is its own source, as on a board without calibration.
RectificationTable identity_table(int width, int height, int offset = 0);

// Whether all valid entries point inside an image of that size.
bool entries_point_inside(const std::uint32_t* entries, std::size_t count, int width, int height);

// The first ten broken rules as `entry (column, row) = 0x...: rule`; empty if the table can be loaded.
std::vector<std::string> problems(const RectificationTable& table);

// Throws std::invalid_argument if the table has problems or is not of the image's size.
void require_usable(const RectificationTable& table, const GrayImage& image);

// Returns the rectified image (P of contract 1.1): source pixels, and 0 where the entry is not valid. Throws
// std::invalid_argument if the sizes differ or the table has problems.
GrayImage rectify(const GrayImage& source, const RectificationTable& table);

}  // namespace stereotlm::kernels
