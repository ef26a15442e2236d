#pragma once

#include <algorithm>
#include <cmath>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// Ground truth as stored, referenced to the left picture: disparity = grey / scale; grey 0 is unknown. It
// keeps the grey values, so that comparisons with an integer scale are exact.
struct Truth {
  kernels::GrayImage grey;
  double scale = 1;  // grey levels per disparity, > 0
};

// The number of candidate disparities (0, 1, ..) that a board needs to find every known disparity of the
// truth, rounded up. It is a double because a small scale takes it beyond every integer.
inline double disparities_needed(const Truth& truth) {
  const auto largest = std::max_element(truth.grey.pixels.begin(), truth.grey.pixels.end());
  return largest == truth.grey.pixels.end() ? 1 : std::ceil(*largest / truth.scale) + 1;
}

}  // namespace stereotlm::media
