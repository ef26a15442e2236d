#pragma once

#include <cstdint>
#include <vector>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// Encodes images to the bytes of a file. In a disparity image kernels::kInvalidDisparity marks invalid
// pixels. Equal images give equal bytes. An image is whole, and not empty.

std::vector<std::uint8_t> encode_png_gray(const kernels::GrayImage& image);

// Disparities 0 .. disparities-1 from dark blue to dark red (Turbo), invalid pixels black.
// disparities: kernels::kDisparitiesRule.
std::vector<std::uint8_t> encode_disparity_color_png(const kernels::GrayImage& disparity, int disparities);

// Portable float map: one channel, little endian (scale -1.0), rows bottom to top, invalid = +infinity.
std::vector<std::uint8_t> encode_pfm(const kernels::GrayImage& disparity);

}  // namespace stereotlm::media
