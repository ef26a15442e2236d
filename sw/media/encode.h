#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"
#include "sw/media/truth.h"

namespace stereotlm::media {

// Files as bytes in memory. In a disparity image kernels::kInvalidDisparity is invalid. An empty image is
// refused with std::invalid_argument. The same image gives the same bytes.

std::vector<std::uint8_t> encode_png_gray(const kernels::GrayImage& image);

// 16-bit grey, row by row. Throws std::invalid_argument if there are not width * height values.
std::vector<std::uint8_t> encode_png_16(int width, int height, const std::vector<std::uint16_t>& values);

// 0 .. disparities-1 from dark blue to dark red (Turbo), invalid black. A value that is neither is refused
// with std::invalid_argument. disparities: kernels::kDisparitiesRule.
std::vector<std::uint8_t> encode_disparity_color_png(const kernels::GrayImage& disparity, int disparities);

// Portable float map: one channel, little endian (scale -1.0), rows bottom to top, invalid = +infinity.
std::vector<std::uint8_t> encode_pfm(const kernels::GrayImage& disparity);

// For display: the nearest whole disparity (halves up), invalid where the truth is unknown or lies outside
// 0 .. disparities-1.
kernels::GrayImage nearest_disparity(const Truth& truth, int disparities);

}  // namespace stereotlm::media
