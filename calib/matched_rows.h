#pragma once

#include "calib/calibration.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::calib {

// The result of matched_rows().
struct MatchedRows {
  std::size_t points = 0;  // distinctive points of the left picture that were searched for
  RowError error;          // of the points that were found
};

// Measures how well the rows of two rectified pictures agree. The most distinctive points of the left picture
// are searched for in the right one, 0..disparities-1 columns to the left and up to 8 rows above or below.
// Only reliable matches count. The mean error indicates whether the tables belong to the cameras: it is below
// one pixel if they do. The function takes about 20 ms at 640x480. Throws std::invalid_argument if the
// pictures differ in size.
MatchedRows matched_rows(const kernels::GrayImage& left, const kernels::GrayImage& right, int disparities);

}  // namespace stereotlm::calib
