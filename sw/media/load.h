#pragma once

#include <string>

#include "models/kernels/gray_image.h"
#include "sw/media/truth.h"

namespace stereotlm::media {

// load_gray() and load_truth() read PNG, JPEG, PGM, PPM and PAM, and by OpenCV BMP, TIFF, WebP, JPEG 2000 and
// Sun raster. The format is detected from the content, not the name. A picture is decoded as stored: an EXIF
// orientation is not applied. Each throws one std::runtime_error `'path': what was found: rule` for
// - a file that is missing, not regular, too long, empty, truncated, damaged or no picture;
// - a picture larger than the largest image of a board, before its pixels are decoded;
// - alpha, transparency, 16-bit and float pixels;
// - grey of fewer than 8 bits (PNG of 1, 2, 4 bits; PNM with a maximum other than 255), whose levels would
// have
//   to be stretched.
// While OpenCV decodes, standard error is captured, so no other thread may write there.

// The result of load_gray().
struct LoadedGray {
  kernels::GrayImage image;
  bool converted_from_colour = false;
};

// 8-bit grey as stored. 8-bit colour is converted with OpenCV's BGR2GRAY; any palette counts as colour.
LoadedGray load_gray(const std::string& path);

// Ground truth; grey only. Throws std::invalid_argument if `scale` is not positive and finite.
Truth load_truth(const std::string& path, double scale);

}  // namespace stereotlm::media
