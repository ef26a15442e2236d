#pragma once

#include "models/kernels/gray_image.h"

namespace stereotlm::demo {

inline constexpr int kWidth = 640;
inline constexpr int kHeight = 480;
// Grey levels per disparity of DemoPair::truth: the full-size truth has one, and half size halves
// disparities.
inline constexpr int kTruthScale = 2;

struct DemoPair {
  kernels::GrayImage left;
  kernels::GrayImage right;
  kernels::GrayImage truth;  // grey / kTruthScale = disparity, 0 = unknown
};

// A full-size pair and its truth (grey = disparity, 0 = unknown) at half size, cropped to the same middle
// kWidth x kHeight of all three, which keeps disparities as they are. A picture is averaged over 2x2 pixels
// (halves up); of the truth the top left one is taken, because depths on both sides of an edge have no mean.
// Throws std::invalid_argument if the sizes differ or are below 2 * kWidth x 2 * kHeight.
DemoPair make_demo_pair(const kernels::GrayImage& left, const kernels::GrayImage& right,
                        const kernels::GrayImage& truth);

// The smallest number of candidates 0, 1, .. that holds every known disparity of the truth, rounded up.
int disparities_needed(const kernels::GrayImage& truth);

}  // namespace stereotlm::demo
