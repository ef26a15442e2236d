#pragma once

#include <string>

#include "models/kernels/gray_image.h"
#include "sw/media/truth.h"

namespace stereotlm::media {

// Both functions take the formats of kPictureFormats; the content decides, not the name. A picture is decoded
// as stored: an EXIF orientation is not applied. One that is larger than the images of a board is not decoded
// at all: its header says so. Each throws one std::runtime_error `'path': what was found: rule` for a file
// that is missing, not regular, empty, truncated, damaged, too large, or no picture, and for alpha,
// transparency, 16-bit, float, and grey of fewer than 8 bits (PNG of 1, 2, 4 bits; PNM with a maximum other
// than 255), whose levels OpenCV would stretch or not, depending on the format. They print nothing: whatever
// a decoder writes to the process's standard error goes aside during the call, so no other thread may write
// there meanwhile.

struct LoadedGray {
  kernels::GrayImage image;
  bool converted_from_colour = false;
};

// 8-bit grey as stored, or 8-bit colour (a palette counts as colour, even one of greys) through OpenCV's
// BGR2GRAY.
LoadedGray load_gray(const std::string& path);

// Ground truth; grey only. `scale` is positive and finite, else std::invalid_argument.
Truth load_truth(const std::string& path, double scale);

}  // namespace stereotlm::media
