#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// For the files of this folder only. The disparity image in colours (BGR) as encode.h says.
cv::Mat in_colors(const kernels::GrayImage& disparity, int disparities);

// The same pixels, not copied: the image must outlive the result, which must not be written to. Throws
// std::invalid_argument if the image is empty or its size and its number of pixels disagree.
cv::Mat view(const kernels::GrayImage& image);

// PNG bytes of a picture of 1 or 3 channels.
std::vector<std::uint8_t> encode_png(const cv::Mat& picture);

}  // namespace stereotlm::media
