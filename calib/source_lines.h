#pragma once

#include <vector>

#include "models/kernels/rectification_table.h"

namespace stereotlm::calib {

// The number of source lines that a front end would have to buffer if it kept lines of the source picture
// instead of reading single pixels. For every `lines` consecutive rows of the rectified picture, from the
// top, it is the number of source rows from the first to the last that a valid entry names, or 0 without
// valid entries. Returns height - lines + 1 values. Throws std::invalid_argument if the table has problems or
// `lines` is not 1..height.
std::vector<int> source_lines(const kernels::RectificationTable& table, int lines);

}  // namespace stereotlm::calib
