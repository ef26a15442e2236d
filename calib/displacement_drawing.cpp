#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "calib/canvas.h"
#include "calib/drawings.h"

namespace stereotlm::calib {
namespace {

constexpr int kLegendHeight = 28;  // pixels

std::uint32_t entry_at(const kernels::RectificationTable& table, int column, int row) {
  return table.entries[static_cast<std::size_t>(row) * static_cast<std::size_t>(table.width) +
                       static_cast<std::size_t>(column)];
}

// The distance of each entry from its source in pixels; -1 where the entry is not valid.
cv::Mat1f distances(const kernels::RectificationTable& table) {
  cv::Mat1f result(table.height, table.width);
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column) {
      const std::uint32_t entry = entry_at(table, column, row);
      const double distance =
          std::hypot(kernels::entry_column(entry) - column, kernels::entry_row(entry) - row);
      result(row, column) = kernels::entry_is_valid(entry) ? static_cast<float>(distance) : -1.0F;
    }
  }
  return result;
}

double largest(const cv::Mat1f& distances) {
  double most = 0;
  cv::minMaxLoc(distances, nullptr, &most);
  return std::max(most, 0.0);
}

// Colours for distances of 0 to `most`. Negative distances are grey.
cv::Mat in_colors(const cv::Mat1f& distances, double most) {
  cv::Mat levels;
  distances.convertTo(levels, CV_8U, most > 0 ? 255 / most : 0);
  cv::Mat colors;
  cv::applyColorMap(levels, colors, cv::COLORMAP_TURBO);
  colors.setTo(kGray, distances < 0);
  return colors;
}

// Draws an arrow in white with a black edge, so that it is visible on every colour. If the arrow is shorter
// than its head, only the head is drawn, or a dot for the shortest.
void draw_arrow(cv::Mat& panel, const cv::Point2d& from, const cv::Point2d& to) {
  constexpr double kLongestPoint = 1.5;  // pixels
  constexpr double kHeadLength = 6;      // pixels
  const double length = cv::norm(to - from);
  if (length <= kLongestPoint) {
    draw_circle(panel, to, 2.5, kBlack, cv::FILLED);
    draw_circle(panel, to, 1.5, kWhite, cv::FILLED);
    return;
  }
  const cv::Point2d back = (from - to) * (std::min(kHeadLength, length) / length);
  const cv::Point2d aside = cv::Point2d(-back.y, back.x) * 0.45;
  const std::vector<cv::Point2d> head = {to, to + back + aside, to + back - aside};
  draw_line(panel, from, to + back, kBlack, 3);
  draw_polygon(panel, head, kBlack, 3);
  draw_line(panel, from, to + back, kWhite);
  draw_polygon(panel, head, kWhite, cv::FILLED);
}

cv::Mat drawn(const kernels::RectificationTable& table, const cv::Mat1f& distances, double most) {
  constexpr int kSpacing = 40;  // pixels of the drawing, at most
  const int factor = enlargement({table.width, table.height});
  cv::Mat panel;
  cv::resize(in_colors(distances, most), panel, {}, factor, factor, cv::INTER_NEAREST);
  const int spacing = std::max(1, kSpacing / factor);
  for (int row = spacing / 2; row < table.height; row += spacing) {
    for (int column = spacing / 2; column < table.width; column += spacing) {
      const std::uint32_t entry = entry_at(table, column, row);
      if (!kernels::entry_is_valid(entry)) continue;
      const cv::Point2d source(kernels::entry_column(entry), kernels::entry_row(entry));
      draw_arrow(panel, enlarged(cv::Point2d(column, row), factor), enlarged(source, factor));
    }
  }
  return panel;
}

void draw_legend(cv::Mat& canvas, int left, int bottom, double most) {
  constexpr int kBarWidth = 160;
  constexpr int kGap = 6;
  constexpr int kWideGap = 30;
  constexpr int kSwatchWidth = 20;
  const int top = bottom - kTextHeight;
  const std::string zero = "0";
  draw_text(canvas, zero, {left, bottom});
  left += text_width(zero) + kGap;

  cv::Mat1f scale(1, kBarWidth);
  for (int x = 0; x < kBarWidth; ++x) scale(0, x) = static_cast<float>(x);
  const cv::Mat colors = in_colors(scale, kBarWidth - 1);
  for (int x = 0; x < kBarWidth; ++x) {
    const cv::Scalar color(colors.at<cv::Vec3b>(0, x));
    cv::line(canvas, {left + x, top}, {left + x, bottom}, color);
  }
  left += kBarWidth + kGap;

  const std::string longest = fmt::format("{:.1f} px", most);
  draw_text(canvas, longest, {left, bottom});
  left += text_width(longest) + kWideGap;
  cv::rectangle(canvas, {left, top}, {left + kSwatchWidth, bottom}, kGray, cv::FILLED);
  draw_text(canvas, "no source", {left + kSwatchWidth + kGap, bottom});
}

}  // namespace

std::vector<std::uint8_t> encode_displacement_png(const kernels::RectificationTable& left,
                                                  const kernels::RectificationTable& right) {
  check_tables(left, right);
  const cv::Mat1f left_distances = distances(left);
  const cv::Mat1f right_distances = distances(right);
  const double most = std::max(largest(left_distances), largest(right_distances));
  Pair pair = side_by_side("left table", drawn(left, left_distances, most), "right table",
                           drawn(right, right_distances, most), kLegendHeight);
  draw_legend(pair.canvas, pair.left.x, pair.left.br().y + kLegendHeight - 4, most);
  return encode_png(pair.canvas);
}

}  // namespace stereotlm::calib
