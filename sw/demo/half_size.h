#pragma once

#include <cstdint>
#include <stdexcept>

#include "models/kernels/gray_image.h"

namespace stereotlm::demo {

// The middle of a picture at half size, 640x480 as the images of fpl2003. A pixel is the mean of 2x2 pixels,
// halves up. A picture of true disparities (`is_truth`) has the top left one instead, because a mean over an
// edge is no depth; its scale doubles. Throws std::invalid_argument for a picture below 1280x960.
inline kernels::GrayImage middle_at_half_size(const kernels::GrayImage& full, bool is_truth = false) {
  kernels::GrayImage half(640, 480);
  if (full.width < 2 * half.width || full.height < 2 * half.height)
    throw std::invalid_argument("a picture must be 1280x960 or larger");
  for (int row = 0; row < half.height; ++row) {
    for (int column = 0; column < half.width; ++column) {
      const int x = 2 * ((full.width / 2 - half.width) / 2 + column);
      const int y = 2 * ((full.height / 2 - half.height) / 2 + row);
      const int sum = full.at(x, y) + full.at(x + 1, y) + full.at(x, y + 1) + full.at(x + 1, y + 1);
      half.at(column, row) = is_truth ? full.at(x, y) : static_cast<std::uint8_t>((sum + 2) / 4);
    }
  }
  return half;
}

}  // namespace stereotlm::demo
