#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace stereotlm::media {

// For the files of this folder only: the one header here that shows OpenCV.

// The picture in `path` as stored: 8 bits, 1 or 3 channels (BGR). Refuses as load.h says.
cv::Mat read_picture(const std::string& path);

}  // namespace stereotlm::media
