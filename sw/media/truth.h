#pragma once

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// Ground truth as stored, referenced to the left picture: disparity = grey / scale; grey 0 is unknown. It
// keeps the grey values, so that comparisons with an integer scale are exact.
struct Truth {
  kernels::GrayImage grey;
  double scale = 1;  // grey levels per disparity, > 0
};

}  // namespace stereotlm::media
