#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"

// Pictures in colour (blue, green, red), side by side, for the drawings of this folder and of sw/demo.
namespace stereotlm::calib {

inline const cv::Scalar kBlack(0, 0, 0);
inline const cv::Scalar kWhite(255, 255, 255);
inline const cv::Scalar kMissing(217, 217, 217);  // where there is no value

// The image, which is not empty, as a picture in colour.
cv::Mat in_grey(const kernels::GrayImage& image);

// Colours (Viridis) for values from `first`, dark, to `last`, bright. `last` may be less than `first`. Values
// beyond them have the colour of the nearer one, and NaN has kMissing.
cv::Mat in_colors(const cv::Mat1f& values, double first, double last);

// Texts below a picture of in_colors(): the first and the last value, and what kMissing stands for.
struct ScaleTexts {
  std::string first;
  std::string last;
  std::string missing;
};

// The picture with a strip of 28 pixels below it, which shows the colours and what they stand for. White on
// the right makes a picture of less than 300 pixels that wide.
cv::Mat with_scale(const cv::Mat& picture, const ScaleTexts& texts);

// A picture and its caption. '?' replaces each byte of the caption that is not ASCII. A caption that is wider
// than the picture shrinks to half its size at most, and is then cut off.
struct Panel {
  std::string caption;
  cv::Mat picture;
};

// Panels side by side on white, aligned at the top, as PNG bytes. The first picture begins 8 pixels from the
// left and 32 from the top.
std::vector<std::uint8_t> encode_panels_png(const std::vector<Panel>& panels);

// A picture as PNG bytes.
std::vector<std::uint8_t> encode_png(const cv::Mat& picture);

}  // namespace stereotlm::calib
