#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// Ground truth as stored, referenced to the left picture: disparity = grey / scale; grey 0 is unknown. It
// keeps the grey values, so that comparisons with an integer scale are exact.
struct Truth {
  kernels::GrayImage grey;
  double scale = 1;  // grey levels per disparity, > 0
};

// The number of candidate disparities (0, 1, ..) that a board needs to find every known disparity of the
// truth, rounded up. It is a double because a small scale takes it beyond every integer.
inline double disparities_needed(const Truth& truth) {
  const auto largest = std::max_element(truth.grey.pixels.begin(), truth.grey.pixels.end());
  return largest == truth.grey.pixels.end() ? 1 : std::ceil(*largest / truth.scale) + 1;
}

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
