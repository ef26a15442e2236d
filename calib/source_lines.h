#pragma once

#include <vector>

#include "models/kernels/rectification_table.h"

namespace stereotlm::calib {

// What a front end that keeps lines of the source picture, in place of reading single pixels of it, would
// have to hold: for every `lines` consecutive rows of the rectified picture, from the top, the number of rows
// of the source picture from the first to the last that a valid entry names; 0 if none is valid. height -
// lines + 1 values. Throws std::invalid_argument if the table has problems or `lines` is not 1..height.
std::vector<int> source_lines(const kernels::RectificationTable& table, int lines);

}  // namespace stereotlm::calib
