#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"

// Drawing functions for the drawings of this folder and of sw/demo. Font and colours are those of the figures
// (sw/report/plots/style.mplstyle). Components of colours are in the order blue, green, red.
namespace stereotlm::calib {

inline const cv::Scalar kBlack(0, 0, 0);
inline const cv::Scalar kWhite(255, 255, 255);
inline const cv::Scalar kGray(128, 128, 128);
inline const cv::Scalar kBlue(178, 114, 0);
inline const cv::Scalar kVermilion(0, 94, 213);
inline const cv::Scalar kMissing(217, 217, 217);  // where there is no value

// The image, which is not empty, as a picture in colour.
cv::Mat in_grey(const kernels::GrayImage& image);

// Colours (Viridis) for values from `first`, dark, to `last`, bright. `last` may be less than `first`. Values
// beyond them have the colour of the nearer one, and NaN has kMissing.
cv::Mat in_colors(const cv::Mat1f& values, double first, double last);

// The size of a text that draw_text() draws. The height is that of digits and capital letters.
inline constexpr int kTextHeight = 10;  // pixels
int text_width(const std::string& text, double scale = 1);

// Draws UTF-8. In any other text, '?' replaces each byte that is not ASCII. `left_bottom` is the bottom left
// corner of the first letter.
void draw_text(cv::Mat& canvas, const std::string& text, cv::Point left_bottom, double scale = 1,
               const cv::Scalar& color = kBlack);

// The next functions draw with anti-aliasing, at positions in fractions of a pixel; (0, 0) is the middle of
// the top left pixel. `thickness` is in pixels.
void draw_line(cv::Mat& canvas, const cv::Point2d& from, const cv::Point2d& to, const cv::Scalar& color,
               int thickness = 1);
void draw_circle(cv::Mat& canvas, const cv::Point2d& middle, double radius, const cv::Scalar& color);
// White with a black edge, so that it is visible on every colour.
void draw_arrow(cv::Mat& canvas, const cv::Point2d& from, const cv::Point2d& to);

// Draws the scale of in_colors() in one line: `first`, the colours, `last`, and what kMissing stands for. It
// is at most `width` pixels wide, if that is at least kLeastScaleWidth.
inline constexpr int kScaleHeight = 28;       // pixels, with its margins
inline constexpr int kLeastScaleWidth = 300;  // pixels, for texts such as those of this program
void draw_color_scale(cv::Mat& canvas, cv::Point left_bottom, int width, const std::string& first,
                      const std::string& last, const std::string& missing);

// A picture and its caption. If wider, the caption shrinks to half its size at most, then is cut off.
struct Panel {
  std::string caption;
  cv::Mat picture;
};
inline constexpr int kMargin = 8;  // pixels, around each picture

// Panels side by side on white, aligned at the top.
struct Montage {
  cv::Mat canvas;
  std::vector<cv::Rect> places;  // of the pictures
};
// `height_below`: height of an empty white strip below the pictures, in pixels.
Montage side_by_side(const std::vector<Panel>& panels, int height_below = 0);

std::vector<std::uint8_t> encode_png(const cv::Mat& canvas);

}  // namespace stereotlm::calib
