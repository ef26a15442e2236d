#include "calib/drawings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/canvas.h"
#include "calib/depth.h"

namespace stereotlm::calib {
namespace {

cv::Size size_of(const kernels::GrayImage& image) { return {image.width, image.height}; }

void check_corners(const GridShape& shape, const kernels::GrayImage& image, const MarkedCorners& marked) {
  const std::size_t count = marked.corners.size();
  if (count != 0 && count != static_cast<std::size_t>(shape.corners())) {
    throw std::invalid_argument(
        fmt::format("corners = {}: must be {}x{}, or 0", count, shape.columns, shape.rows));
  }
  if (!marked.left_out.empty() && marked.left_out.size() != count) {
    throw std::invalid_argument(
        fmt::format("left_out = {}: must be one for each corner, {}, or 0", marked.left_out.size(), count));
  }
  for (const Eigen::Vector2d& corner : marked.corners) {
    if (!(corner.x() >= -0.5 && corner.x() <= image.width - 0.5 && corner.y() >= -0.5 &&
          corner.y() <= image.height - 0.5)) {
      throw std::invalid_argument(fmt::format("corner = ({}, {}): must lie inside the picture of {}x{}",
                                              corner.x(), corner.y(), image.width, image.height));
    }
  }
}

cv::Scalar row_color(int row) {
  static const std::array<cv::Scalar, 6> colors = {{{0, 150, 255},     // orange
                                                    {0, 220, 220},     // yellow
                                                    {40, 200, 40},     // green
                                                    {220, 200, 0},     // cyan
                                                    {255, 110, 40},    // blue
                                                    {230, 60, 200}}};  // violet
  return colors[static_cast<std::size_t>(row) % colors.size()];
}

void draw_cross(cv::Mat& picture, const cv::Point2d& middle) {
  constexpr double kReach = 5;
  const cv::Scalar red(0, 0, 255);
  draw_line(picture, middle - cv::Point2d(kReach, kReach), middle + cv::Point2d(kReach, kReach), red, 2);
  draw_line(picture, middle - cv::Point2d(kReach, -kReach), middle + cv::Point2d(kReach, -kReach), red, 2);
}

void draw_square(cv::Mat& picture, const cv::Point2d& middle, const cv::Scalar& color) {
  constexpr double kReach = 8;
  const cv::Point2d down(kReach, kReach);
  const cv::Point2d up(kReach, -kReach);
  draw_polygon(picture, {middle - down, middle + up, middle + down, middle - up}, color, 2);
}

cv::Mat with_corners(const GridShape& shape, const kernels::GrayImage& image, const MarkedCorners& marked) {
  constexpr double kRadius = 4;
  check_corners(shape, image, marked);
  cv::Mat picture = enlarged(image);
  std::vector<cv::Point2d> middles;
  for (const Eigen::Vector2d& corner : marked.corners) {
    middles.push_back(enlarged({corner.x(), corner.y()}, enlargement(size_of(image))));
  }
  const auto color = [&shape](std::size_t i) { return row_color(static_cast<int>(i) / shape.columns); };
  for (std::size_t i = 1; i < middles.size(); ++i) {
    draw_line(picture, middles[i - 1], middles[i], color(i));
  }
  for (std::size_t i = 0; i < middles.size(); ++i) {
    if (i == 0) draw_square(picture, middles[i], color(i));
    if (!marked.left_out.empty() && marked.left_out[i]) {
      draw_cross(picture, middles[i]);
    } else {
      draw_circle(picture, middles[i], kRadius, color(i));
    }
  }
  return picture;
}

}  // namespace

std::vector<std::uint8_t> encode_corners_png(const GridShape& shape, const CaptionedImage& left,
                                             const MarkedCorners& left_corners, const CaptionedImage& right,
                                             const MarkedCorners& right_corners) {
  check_sizes(size_of(left.image), size_of(right.image));
  return encode_png(side_by_side(left.caption, with_corners(shape, left.image, left_corners), right.caption,
                                 with_corners(shape, right.image, right_corners))
                        .canvas);
}

std::vector<std::uint8_t> encode_rectified_pair_png(const CaptionedImage& left, const CaptionedImage& right) {
  constexpr int kSpacing = 32;  // pixels of the drawing, at most
  const std::array<cv::Scalar, 2> colors = {{{0, 150, 255}, {220, 200, 0}}};  // orange, cyan
  check_sizes(size_of(left.image), size_of(right.image));
  Pair pair = side_by_side(left.caption, enlarged(left.image), right.caption, enlarged(right.image));
  const int factor = enlargement(size_of(left.image));
  const int spacing = kSpacing / factor;
  std::size_t count = 0;
  for (int row = spacing / 2; row < left.image.height; row += spacing) {
    const int y = pair.left.y + row * factor + factor / 2;
    cv::line(pair.canvas, {pair.left.x, y}, {pair.right.br().x - 1, y}, colors[count++ % colors.size()]);
  }
  return encode_png(pair.canvas);
}

std::vector<std::uint8_t> encode_depth_color_png(int width, int height,
                                                 const std::vector<std::uint16_t>& millimetres) {
  if (width < 1 || height < 1 ||
      static_cast<long long>(width) * height != static_cast<long long>(millimetres.size())) {
    throw std::invalid_argument(fmt::format("depths = {}x{} with {} values: must be whole and not empty",
                                            width, height, millimetres.size()));
  }
  const std::optional<DepthRange> range = depth_range(millimetres);
  cv::Mat1f depths(height, width, std::numeric_limits<float>::quiet_NaN());
  std::transform(millimetres.begin(), millimetres.end(), depths.begin(), depths.begin(),
                 [](int depth, float unknown) { return depth > 0 ? static_cast<float>(depth) : unknown; });
  const DepthRange shown = range.value_or(DepthRange{0, 1});
  cv::Mat canvas(height + kScaleHeight, std::max(width, kLeastScaleWidth), CV_8UC3, kWhite);
  in_colors(depths, shown.far_mm, shown.near_mm).copyTo(canvas({0, 0, width, height}));
  draw_color_scale(canvas, {kMargin, height + kScaleHeight - kMargin}, canvas.cols - 2 * kMargin,
                   fmt::format("{} mm", shown.far_mm), fmt::format("{} mm", shown.near_mm), "unknown");
  return encode_png(canvas);
}

}  // namespace stereotlm::calib
