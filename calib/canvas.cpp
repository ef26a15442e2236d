#include "calib/canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

constexpr int kMargin = 8;          // pixels, around each picture
constexpr int kCaptionHeight = 24;  // pixels
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.5;
constexpr double kSmallestScale = 0.5;
constexpr int kFractionBits = 4;  // of the fixed-point positions and lengths for OpenCV
// OpenCV cannot draw positions beyond this limit, in pixels.
constexpr double kFarthest = 1e5;

int fixed_point(double pixels) {
  return static_cast<int>(std::lround(std::clamp(pixels, -kFarthest, kFarthest) * (1 << kFractionBits)));
}

cv::Point fixed_point(const cv::Point2d& point) { return {fixed_point(point.x), fixed_point(point.y)}; }

void draw_caption(cv::Mat& canvas, const std::string& caption, const cv::Rect& picture) {
  const double fits = static_cast<double>(picture.width) / std::max(text_width(caption), 1);
  cv::Mat above = canvas({picture.x, 0, picture.width, picture.y});
  draw_text(above, caption, {0, picture.y - 8}, std::clamp(fits, kSmallestScale, 1.0));
}

}  // namespace

void check_sizes(cv::Size left, cv::Size right) {
  if (left != right) {
    throw std::invalid_argument(fmt::format("right = {}x{}: must be as large as left, {}x{}", right.width,
                                            right.height, left.width, left.height));
  }
}

void check_tables(const kernels::RectificationTable& left, const kernels::RectificationTable& right) {
  check_sizes({left.width, left.height}, {right.width, right.height});
  for (const kernels::RectificationTable* table : {&left, &right}) {
    if (const auto found = problems(*table); !found.empty()) throw std::invalid_argument(found.front());
  }
}

int enlargement(cv::Size size) {
  constexpr int kLargeEnough = 320;  // pixels
  return std::max(1, kLargeEnough / std::max({size.width, size.height, 1}));
}

cv::Mat enlarged(const kernels::GrayImage& image) {
  const auto pixels = static_cast<long long>(image.width) * image.height;
  if (image.width < 1 || image.height < 1 || pixels != static_cast<long long>(image.pixels.size())) {
    throw std::invalid_argument(fmt::format("image = {}x{} with {} pixels: must be whole and not empty",
                                            image.width, image.height, image.pixels.size()));
  }
  const double factor = enlargement({image.width, image.height});
  cv::Mat result;
  cv::cvtColor(view(image), result, cv::COLOR_GRAY2BGR);
  cv::resize(result, result, {}, factor, factor, cv::INTER_NEAREST);
  return result;
}

cv::Point2d enlarged(const cv::Point2d& pixel, int enlargement) {
  const cv::Point2d half(0.5, 0.5);
  return (pixel + half) * enlargement - half;
}

int text_width(const std::string& text, double scale) {
  return cv::getTextSize(text, kFont, scale * kFontScale, 1, nullptr).width;
}

void draw_text(cv::Mat& canvas, const std::string& text, cv::Point left_bottom, double scale,
               const cv::Scalar& color) {
  cv::putText(canvas, text, left_bottom, kFont, scale * kFontScale, color, 1, cv::LINE_AA);
}

void draw_line(cv::Mat& canvas, const cv::Point2d& from, const cv::Point2d& to, const cv::Scalar& color,
               int thickness) {
  cv::line(canvas, fixed_point(from), fixed_point(to), color, thickness, cv::LINE_AA, kFractionBits);
}

void draw_circle(cv::Mat& canvas, const cv::Point2d& middle, double radius, const cv::Scalar& color,
                 int thickness) {
  cv::circle(canvas, fixed_point(middle), fixed_point(radius), color, thickness, cv::LINE_AA, kFractionBits);
}

void draw_polygon(cv::Mat& canvas, const std::vector<cv::Point2d>& points, const cv::Scalar& color,
                  int thickness) {
  std::vector<cv::Point> corners;
  corners.reserve(points.size());
  for (const cv::Point2d& point : points) corners.push_back(fixed_point(point));
  if (thickness == cv::FILLED) {
    cv::fillConvexPoly(canvas, corners, color, cv::LINE_AA, kFractionBits);
  } else {
    cv::polylines(canvas, corners, true, color, thickness, cv::LINE_AA, kFractionBits);
  }
}

Pair side_by_side(const std::string& left_caption, const cv::Mat& left, const std::string& right_caption,
                  const cv::Mat& right, int height_below) {
  const int width = left.cols;
  const int height = left.rows;
  const int top = kMargin + kCaptionHeight;
  Pair pair;
  pair.left = {kMargin, top, width, height};
  pair.right = {kMargin + width + kMargin, top, width, height};
  pair.canvas = cv::Mat(top + height + kMargin + height_below, pair.right.br().x + kMargin, CV_8UC3, kWhite);
  left.copyTo(pair.canvas(pair.left));
  right.copyTo(pair.canvas(pair.right));
  draw_caption(pair.canvas, left_caption, pair.left);
  draw_caption(pair.canvas, right_caption, pair.right);
  return pair;
}

std::vector<std::uint8_t> encode_png(const cv::Mat& canvas) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", canvas, bytes)) throw std::runtime_error("a drawing could not be encoded as PNG");
  return bytes;
}

}  // namespace stereotlm::calib
