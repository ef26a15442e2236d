#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/rectification_table.h"

namespace stereotlm::kernels {

// One table for both sides (contract 7.3). Its word for a pixel holds a displacement of each side, 16 bits
// each: bit 15 valid, bits 14..8 rows + 64, bits 7..0 columns + 128. The left side has the upper half of the
// word. The source of a pixel is its own position, plus the displacement, plus the offset of the side.
inline constexpr int kJointColumns = 256;  // range of the displacements of a side
inline constexpr int kJointRows = 128;

// Added to all displacements of a side, in pixels.
struct JointOffset {
  int columns = 0;  // pixels to the right
  int rows = 0;     // pixels downwards

  friend bool operator==(const JointOffset& a, const JointOffset& b) {
    return a.columns == b.columns && a.rows == b.rows;
  }
  friend bool operator!=(const JointOffset& a, const JointOffset& b) { return !(a == b); }
};
using JointOffsets = std::array<JointOffset, 2>;  // left, right

// The joined table, and what its displacements are relative to.
struct JointTable {
  std::vector<std::uint32_t> words;  // row-major, one for each pixel
  JointOffsets offsets;              // offsets of both sides
};

// Why two tables cannot be joined: a text for each side and coordinate whose displacements need a larger
// range than there is. Empty if they can be joined. Both tables have one size and no problems.
std::vector<std::string> joint_problems(const RectificationTable& left, const RectificationTable& right);

// Joins two tables. The offsets are the middles of the ranges that the valid entries of a side need. Throws
// std::invalid_argument if the tables cannot be joined.
JointTable join_tables(const RectificationTable& left, const RectificationTable& right);

// The entry of one side, as in a table of its own; 0 if it is not valid. `half`: that side's half of the
// word of pixel (column, row). The coordinates of the source have 11 bits, as in the entry.
constexpr std::uint32_t entry_of_joint_half(std::uint32_t half, int column, int row,
                                            const JointOffset& offset) {
  if ((half & 0x8000U) == 0) return 0;
  // The registers may hold anything: unsigned sums do not overflow.
  const auto coordinate = [](int place, std::uint32_t displacement, int range, int offset_of_side) {
    const std::uint32_t sum = static_cast<std::uint32_t>(place) + displacement -
                              static_cast<std::uint32_t>(range / 2) +
                              static_cast<std::uint32_t>(offset_of_side);
    return static_cast<int>(sum & 0x7FFU);
  };
  return make_entry(coordinate(column, half & 0xFFU, kJointColumns, offset.columns),
                    coordinate(row, half >> 8U & 0x7FU, kJointRows, offset.rows));
}
// The entry of the left side. `word`: that of pixel (column, row).
constexpr std::uint32_t left_entry(std::uint32_t word, int column, int row, const JointOffsets& offsets) {
  return entry_of_joint_half(word >> 16U, column, row, offsets[0]);
}
// The entry of the right side. `word`: that of pixel (column, row).
constexpr std::uint32_t right_entry(std::uint32_t word, int column, int row, const JointOffsets& offsets) {
  return entry_of_joint_half(word & 0xFFFFU, column, row, offsets[1]);
}

}  // namespace stereotlm::kernels
