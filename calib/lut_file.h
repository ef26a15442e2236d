#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "models/kernels/rectification_table.h"

namespace stereotlm::calib {

// The file of a table: its entries row by row, 32 bits each, little endian.
std::string lut_bytes(const kernels::RectificationTable& table);

// How many bytes the file of a table for images of this size has.
std::size_t lut_byte_count(int width, int height);

// Throws std::runtime_error if that is not the file of a table for images of this size, or an entry is none.
kernels::RectificationTable parse_lut(std::string_view bytes, int width, int height);

}  // namespace stereotlm::calib
