#pragma once

#include <optional>

#include "models/kernels/gray_image.h"
#include "sw/media/truth.h"

namespace stereotlm::report {

// Percentages, 0..100, as the end of contract section 6 defines them. nullopt: the denominator is 0.
struct Accuracy {
  std::optional<double> bad_1_percent;     // answered pixels that are wrong by more than 1 disparity
  std::optional<double> bad_2_percent;     // answered pixels that are wrong by more than 2
  std::optional<double> answered_percent;  // known pixels, not occluded, that are answered
};

// `disparity`: referenced to the left picture; a pixel of kernels::kInvalidDisparity is not answered. Throws
// std::invalid_argument if the sizes differ.
Accuracy accuracy(const kernels::GrayImage& disparity, const media::Truth& truth);

}  // namespace stereotlm::report
