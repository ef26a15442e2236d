#pragma once

#include "calib/grid_in_view.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

struct MatchedRows {
  std::size_t points = 0;  // conspicuous ones of the left picture that could be looked for
  RowError error;          // of those that were found
};

// How well the rows of two rectified pictures agree, from what they show: the most conspicuous points of the
// left one are looked for in the right one, 0 .. disparities-1 columns to the left and up to 8 rows above or
// below, and those found beyond doubt count. A hint whether the tables belong to the cameras: those of the
// rig itself come out below one pixel. Costs some 20 ms at 640x480. Throws std::invalid_argument if the
// pictures differ in size.
MatchedRows matched_rows(const kernels::GrayImage& left, const kernels::GrayImage& right, int disparities);

}  // namespace stereotlm::calib
