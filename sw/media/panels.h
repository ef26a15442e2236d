#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// One picture of a row of pictures.
struct Panel {
  std::string caption;       // ASCII; drawn smaller if it is wider than the picture
  kernels::GrayImage image;  // not empty
  int disparities = 0;       // 0: shown in grey; 1..254: a disparity image, shown in colours
};

// A PNG with the pictures side by side on white, aligned at the top, each below its caption. Throws
// std::invalid_argument if there is no panel or an image cannot be shown (encode.h).
std::vector<std::uint8_t> encode_side_by_side_png(const std::vector<Panel>& panels);

}  // namespace stereotlm::media
