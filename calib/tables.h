#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "calib/rig.h"
#include "models/kernels/rectification_table.h"

namespace stereotlm::calib {

struct TablePair {
  kernels::RectificationTable left;
  kernels::RectificationTable right;
};

// The entry of contract 1.1 for a position of the rectified picture: the nearest pixel of the camera's
// picture (floor(x + 0.5)), valid if it lies inside the picture.
std::uint32_t table_entry(const Rig& rig, const SourcePixels& sources, const Eigen::Vector2d& rectified);

// Column x of the left table is column x + disparity_offset of the rectified left picture. Throws
// std::invalid_argument if the pictures are larger than 2048 x 2048.
TablePair tables(const Rig& rig, const Rectification& rectification, int disparity_offset);

// Whether tables() would make `tables`, which must have the size of the rig's pictures. Compares about one
// entry in a hundred.
bool are_tables_of(const TablePair& tables, const Rig& rig, const Rectification& rectification,
                   int disparity_offset);

// The file of a table: its entries row by row, 32 bits each, little endian.
std::string lut_bytes(const kernels::RectificationTable& table);

// The size in bytes of the table file for images of this size.
std::size_t lut_byte_count(int width, int height);

// Throws std::runtime_error if the bytes are no table for images of this size, or the table has problems.
kernels::RectificationTable parse_lut(std::string_view bytes, int width, int height);

// The number of entries that are not valid.
std::size_t entries_without_source(const kernels::RectificationTable& table);

// Whether more than half of the entries are not valid: no rig whose cameras see the same needs that.
bool is_mostly_empty(const kernels::RectificationTable& table);

// Throws std::invalid_argument if a table is mostly empty: such a calibration cannot rectify.
void check_sources(const TablePair& tables, int disparity_offset);

// How many source lines a front end would have to buffer if it kept lines instead of reading single pixels.
// For a window of `lines` rows of the rectified picture these are the lines from the first to the last one
// that a valid entry of these rows names. Returns the largest number of all places of the window; 0 without
// valid entries. Throws std::invalid_argument if the table has problems or `lines` is not 1..height.
int source_lines(const kernels::RectificationTable& table, int lines);

}  // namespace stereotlm::calib
