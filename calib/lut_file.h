#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "models/kernels/rectification_table.h"

namespace stereotlm::calib {

// The file of a table: its entries row by row, 32 bits each, little endian.
std::string lut_bytes(const kernels::RectificationTable& table);

// The size in bytes of the table file for images of this size.
std::size_t lut_byte_count(int width, int height);

// Throws std::runtime_error if the bytes are not a table for images of this size, or if the table has
// problems.
kernels::RectificationTable parse_lut(std::string_view bytes, int width, int height);

}  // namespace stereotlm::calib
