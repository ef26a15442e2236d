#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "models/kernels/gray_image.h"
#include "models/kernels/rectification_table.h"

// Common parts of the drawings of this folder, for its files only. Colours are blue, green, red.
namespace stereotlm::calib {

inline const cv::Scalar kBlack(0, 0, 0);
inline const cv::Scalar kWhite(255, 255, 255);
inline const cv::Scalar kGray(128, 128, 128);

// Throw std::invalid_argument if the sizes differ, or if a table has problems.
void check_sizes(cv::Size left, cv::Size right);
void check_tables(const kernels::RectificationTable& left, const kernels::RectificationTable& right);

// The factor by which pictures of this size are enlarged each way.
int enlargement(cv::Size size);

// The image in colour, enlarged. Throws std::invalid_argument if the image is empty or not whole.
cv::Mat enlarged(const kernels::GrayImage& image);

// The position of a pixel in the enlarged picture.
cv::Point2d enlarged(const cv::Point2d& pixel, int enlargement);

// Sizes of text by draw_text(); the height is that of digits and capital letters.
inline constexpr int kTextHeight = 11;  // pixels
int text_width(const std::string& text, double scale = 1);

// `left_bottom` is the corner of the first letter.
void draw_text(cv::Mat& canvas, const std::string& text, cv::Point left_bottom, double scale = 1,
               const cv::Scalar& color = kBlack);

// These draw with smooth edges at fractions of a pixel; (0, 0) is the middle of the first pixel. Thickness is
// in pixels, or cv::FILLED.
void draw_line(cv::Mat& canvas, const cv::Point2d& from, const cv::Point2d& to, const cv::Scalar& color,
               int thickness = 1);
void draw_circle(cv::Mat& canvas, const cv::Point2d& middle, double radius, const cv::Scalar& color,
                 int thickness = 1);
// A filled polygon must be convex.
void draw_polygon(cv::Mat& canvas, const std::vector<cv::Point2d>& points, const cv::Scalar& color,
                  int thickness = 1);

// Two pictures of one size side by side under their captions, on white. `height_below` adds white, in pixels.
struct Pair {
  cv::Mat canvas;
  cv::Rect left;  // places of the pictures
  cv::Rect right;
};
Pair side_by_side(const std::string& left_caption, const cv::Mat& left, const std::string& right_caption,
                  const cv::Mat& right, int height_below = 0);

std::vector<std::uint8_t> encode_png(const cv::Mat& canvas);

}  // namespace stereotlm::calib
