#pragma once

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// Ground truth as stored: disparity = grey / scale, left-referenced; grey 0 = unknown. The grey values are
// kept, so that comparisons with a whole scale are exact.
struct Truth {
  kernels::GrayImage grey;
  double scale = 1;  // grey levels per disparity, > 0
};

}  // namespace stereotlm::media
