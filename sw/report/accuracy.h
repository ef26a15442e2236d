#pragma once

#include <optional>

#include "models/kernels/gray_image.h"
#include "sw/media/truth.h"

namespace stereotlm::report {

// Percentages, 0..100, as the end of contract section 6 defines them; none where the denominator is empty.
struct Accuracy {
  std::optional<double> bad_1_percent;     // of the answered pixels, those off by more than 1 disparity
  std::optional<double> bad_2_percent;     // by more than 2
  std::optional<double> answered_percent;  // of the known pixels that are not occluded
};

// `disparity`: left-referenced; kernels::kInvalidDisparity is not answered. Throws std::invalid_argument if
// the sizes differ.
Accuracy accuracy(const kernels::GrayImage& disparity, const media::Truth& truth);

}  // namespace stereotlm::report
