#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// Internal to this folder.

// Throws std::invalid_argument if `disparities` is not allowed by kernels::kDisparitiesRule, or if a pixel is
// neither less than `disparities` nor kernels::kInvalidDisparity.
void check_levels(const kernels::GrayImage& disparity, int disparities);

// A view of the image's pixels. The image must outlive the view; the view must not be written to. Throws
// std::invalid_argument if the image is empty or its number of pixels does not fit its size.
cv::Mat view(const kernels::GrayImage& image);

// PNG bytes of a picture of 1 or 3 channels.
std::vector<std::uint8_t> encode_png(const cv::Mat& picture);

}  // namespace stereotlm::media
