#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace stereotlm::media {

// Internal to this folder: this header exposes OpenCV.

// The picture in `path` as stored: 8 bits, 1 or 3 channels (BGR). Throws as load.h states.
cv::Mat read_picture(const std::string& path);

}  // namespace stereotlm::media
