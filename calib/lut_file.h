#pragma once

#include <string>
#include <string_view>

#include "models/kernels/rectification_table.h"

namespace stereotlm::calib {

// The file of a table: its entries row by row, 32 bits each, little endian.
std::string lut_bytes(const kernels::RectificationTable& table);

// Throws std::runtime_error if that is not the file of a table for images of this size, or an entry is none.
kernels::RectificationTable parse_lut(std::string_view bytes, int width, int height);

}  // namespace stereotlm::calib
