#include "calib/drawings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/canvas.h"
#include "calib/depth.h"
#include "calib/tables.h"

namespace stereotlm::calib {
namespace {

cv::Scalar row_color(int row) {
  static const std::array<cv::Scalar, 6> colors = {{{0, 150, 255},     // orange
                                                    {0, 220, 220},     // yellow
                                                    {40, 200, 40},     // green
                                                    {220, 200, 0},     // cyan
                                                    {255, 110, 40},    // blue
                                                    {230, 60, 200}}};  // violet
  return colors[static_cast<std::size_t>(row) % colors.size()];
}

cv::Mat with_corners(const GridShape& shape, const kernels::GrayImage& image, const MarkedCorners& marked) {
  constexpr double kRadius = 4;
  constexpr int kCross = 10;  // width of a marker
  constexpr int kSquare = 16;
  const cv::Scalar red(0, 0, 255);
  cv::Mat picture = in_grey(image);
  std::vector<cv::Point2d> middles;
  for (const Eigen::Vector2d& corner : marked.corners) middles.emplace_back(corner.x(), corner.y());
  const auto color = [&shape](std::size_t i) { return row_color(static_cast<int>(i) / shape.columns); };
  for (std::size_t i = 1; i < middles.size(); ++i) draw_line(picture, middles[i - 1], middles[i], color(i));
  for (std::size_t i = 0; i < middles.size(); ++i) {
    if (i == 0) cv::drawMarker(picture, middles[i], color(i), cv::MARKER_SQUARE, kSquare, 2);
    if (!marked.left_out.empty() && marked.left_out[i]) {
      cv::drawMarker(picture, middles[i], red, cv::MARKER_TILTED_CROSS, kCross, 2);
    } else {
      draw_circle(picture, middles[i], kRadius, color(i));
    }
  }
  return picture;
}

constexpr int kSpacing = 40;  // of the arrows, in pixels

// From the position of an entry to its source; nullopt if the entry is not valid.
std::optional<cv::Point2d> displacement(const kernels::RectificationTable& table, int column, int row) {
  const std::uint32_t entry =
      table.entries[static_cast<std::size_t>(row) * static_cast<std::size_t>(table.width) +
                    static_cast<std::size_t>(column)];
  if (!kernels::entry_is_valid(entry)) return std::nullopt;
  return cv::Point2d(kernels::entry_column(entry) - column, kernels::entry_row(entry) - row);
}

// What a table moves besides its offset.
struct Moves {
  cv::Point2d offset;  // the mean of all displacements: what the table moves the whole picture by
  cv::Mat1f lengths;   // of the displacements less the offset, in pixels; NaN where the entry is not valid
  double largest = 0;  // of the lengths
};

Moves moves_of(const kernels::RectificationTable& table) {
  Moves moves;
  cv::Mat_<cv::Point2d> moved(table.height, table.width);
  cv::Mat1b is_valid(table.height, table.width, std::uint8_t{0});
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column) {
      const auto found = displacement(table, column, row);
      is_valid(row, column) = found ? 255 : 0;
      moved(row, column) = found.value_or(cv::Point2d());
      moves.offset += moved(row, column);
    }
  }
  moves.offset /= std::max(cv::countNonZero(is_valid), 1);
  moves.lengths = cv::Mat1f(table.height, table.width, std::numeric_limits<float>::quiet_NaN());
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column) {
      if (is_valid(row, column) == 0) continue;
      moves.lengths(row, column) = static_cast<float>(cv::norm(moved(row, column) - moves.offset));
      moves.largest = std::max<double>(moves.largest, moves.lengths(row, column));
    }
  }
  return moves;
}

// The factor by which arrows are lengthened so that none reaches the next: 1, 2 or 5 times a power of ten.
// `most`: the length of the longest one, in pixels.
double arrow_factor(double most) {
  constexpr double kShareOfSpacing = 0.9;
  constexpr double kLargest = 100;
  const double fits = std::min(kLargest, kShareOfSpacing * kSpacing / std::max(most, 1e-9));
  const double power = std::pow(10, std::floor(std::log10(fits) + 1e-9));
  for (const double digit : {5.0, 2.0}) {
    if (digit * power <= fits) return digit * power;
  }
  return power;
}

cv::Mat drawn(const kernels::RectificationTable& table, const Moves& moves, double most, double arrows) {
  cv::Mat panel = in_colors(moves.lengths, 0, most);
  for (int row = kSpacing / 2; row < table.height; row += kSpacing) {
    for (int column = kSpacing / 2; column < table.width; column += kSpacing) {
      const cv::Point2d from(column, row);
      if (const auto moved = displacement(table, column, row))
        draw_arrow(panel, from, from + (*moved - moves.offset) * arrows);
    }
  }
  return panel;
}

std::string caption(const std::string& name, const Moves& moves, double arrows) {
  const auto shown = [](double offset) { return std::round(10 * offset) / 10 + 0.0; };  // no "-0.0"
  return fmt::format("{} without its offset ({:+.1f}, {:+.1f}) px; arrows {:g} times as long", name,
                     shown(moves.offset.x), shown(moves.offset.y), arrows);
}

constexpr int kMostLines = 31;
constexpr int kTickLength = 5;  // pixels
const cv::Size kChartSize(800, 500);
const cv::Rect kPlot(52, 68, 724, 372);  // inside the axes
const cv::Scalar kGridColor(221, 221, 221);

struct Curve {
  std::string name;
  cv::Scalar color;
  int thickness = 1;           // pixels
  double mark = 0;             // radius of its rings, pixels
  std::vector<double> values;  // [i]: for lines_of(i)
};

int lines_of(std::size_t index) { return 1 + 2 * static_cast<int>(index); }

// Two curves of source_lines(): the largest number in the picture, and the mean.
std::vector<Curve> curves_of(const kernels::RectificationTable& table, const std::string& side,
                             const cv::Scalar& color, double mark) {
  Curve largest{side + ", maximum", color, 2, mark, {}};
  Curve mean{side + ", mean", color, 1, mark, {}};
  const int most = std::min(kMostLines, table.height);
  for (std::size_t i = 0; lines_of(i) <= most; ++i) {
    const std::vector<int> counts = source_lines(table, lines_of(i));
    largest.values.push_back(*std::max_element(counts.begin(), counts.end()));
    mean.values.push_back(std::accumulate(counts.begin(), counts.end(), 0.0) /
                          static_cast<double>(counts.size()));
  }
  return {largest, mean};
}

// The vertical axis: from 0 to a multiple of the step, in ten steps at most.
struct Axis {
  int step = 1;
  int end = 1;
};

Axis axis_to(double most) {
  const int step = std::max(1, cvCeil(most / 10));
  return {step, std::max(1, cvCeil(most / step)) * step};
}

cv::Point2d place(const Axis& axis, double lines, double y) {
  return {kPlot.x + lines / (kMostLines + 1) * kPlot.width, kPlot.br().y - y / axis.end * kPlot.height};
}

void draw_axes(cv::Mat& chart, const Axis& axis) {
  for (int y = 0; y <= axis.end; y += axis.step) {
    const cv::Point2d tick = place(axis, 0, y);
    draw_line(chart, tick, place(axis, kMostLines + 1, y), kGridColor);
    draw_line(chart, tick - cv::Point2d(kTickLength, 0), tick, kBlack);
    const std::string label = std::to_string(y);
    draw_text(chart, label,
              {kPlot.x - kTickLength - 4 - text_width(label), cvRound(tick.y) + kTextHeight / 2});
  }
  for (int lines = 1; lines <= kMostLines; lines += 2) {
    const cv::Point2d tick = place(axis, lines, 0);
    draw_line(chart, tick, tick + cv::Point2d(0, kTickLength), kBlack);
    const std::string label = std::to_string(lines);
    draw_text(chart, label,
              {cvRound(tick.x) - text_width(label) / 2, kPlot.br().y + kTickLength + 6 + kTextHeight});
  }
  draw_line(chart, place(axis, 0, axis.end), place(axis, 0, 0), kBlack);
  draw_line(chart, place(axis, 0, 0), place(axis, kMostLines + 1, 0), kBlack);
  draw_text(chart,
            "Lines of the camera's picture, from first to last, that n rows of the rectified picture take "
            "pixels from",
            {12, 24});
  const std::string below = "n, rows of the rectified picture";
  draw_text(chart, below, {kPlot.x + (kPlot.width - text_width(below)) / 2, kChartSize.height - 14});
}

void draw_curve(cv::Mat& chart, const Axis& axis, const Curve& curve) {
  for (std::size_t i = 0; i < curve.values.size(); ++i) {
    const cv::Point2d point = place(axis, lines_of(i), curve.values[i]);
    if (i > 0) {
      draw_line(chart, place(axis, lines_of(i - 1), curve.values[i - 1]), point, curve.color,
                curve.thickness);
    }
    draw_circle(chart, point, curve.mark, curve.color);
  }
}

// Draws the legend as one line above the plot.
void draw_legend(cv::Mat& chart, const std::vector<Curve>& curves) {
  constexpr int kSample = 28;
  const int bottom = kPlot.y - 16;
  int left = kPlot.x;
  for (const Curve& curve : curves) {
    const cv::Point2d middle(left + kSample / 2.0, bottom - kTextHeight / 2.0);
    const cv::Point2d half(kSample / 2.0, 0);
    draw_line(chart, middle - half, middle + half, curve.color, curve.thickness);
    draw_circle(chart, middle, curve.mark, curve.color);
    draw_text(chart, curve.name, {left + kSample + 6, bottom});
    left += kSample + 6 + text_width(curve.name) + 20;
  }
}

}  // namespace

std::vector<std::uint8_t> encode_corners_png(const GridShape& shape, const CaptionedImage& left,
                                             const MarkedCorners& left_corners, const CaptionedImage& right,
                                             const MarkedCorners& right_corners) {
  return encode_png(side_by_side({{left.caption, with_corners(shape, left.image, left_corners)},
                                  {right.caption, with_corners(shape, right.image, right_corners)}})
                        .canvas);
}

std::vector<std::uint8_t> encode_rectified_pair_png(const CaptionedImage& left, const CaptionedImage& right) {
  constexpr int kRows = 32;                                                   // from line to line
  const std::array<cv::Scalar, 2> colors = {{{0, 150, 255}, {220, 200, 0}}};  // orange, cyan
  auto [canvas, places] =
      side_by_side({{left.caption, in_grey(left.image)}, {right.caption, in_grey(right.image)}});
  std::size_t count = 0;
  for (int row = kRows / 2; row < left.image.height; row += kRows) {
    const int y = places[0].y + row;
    cv::line(canvas, {places[0].x, y}, {places[1].br().x - 1, y}, colors[count++ % colors.size()]);
  }
  return encode_png(canvas);
}

std::vector<std::uint8_t> encode_depth_color_png(int width, int height,
                                                 const std::vector<std::uint16_t>& millimetres) {
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

std::vector<std::uint8_t> encode_displacement_png(const kernels::RectificationTable& left,
                                                  const kernels::RectificationTable& right) {
  const Moves of_left = moves_of(left);
  const Moves of_right = moves_of(right);
  const double most = std::max(of_left.largest, of_right.largest);
  const double arrows = arrow_factor(most);
  auto [canvas, places] =
      side_by_side({{caption("left table", of_left, arrows), drawn(left, of_left, most, arrows)},
                    {caption("right table", of_right, arrows), drawn(right, of_right, most, arrows)}},
                   kScaleHeight);
  draw_color_scale(canvas, {places[0].x, places[0].br().y + kScaleHeight - 4}, places[0].width, "0",
                   fmt::format("{:.1f} px", most), "no source");
  return encode_png(canvas);
}

std::vector<std::uint8_t> encode_source_lines_png(const kernels::RectificationTable& left,
                                                  const kernels::RectificationTable& right) {
  std::vector<Curve> curves = {{"n", kGray, 1, 0, {}}};
  for (const Curve& curve : curves_of(left, "left", kBlue, 5)) curves.push_back(curve);
  for (const Curve& curve : curves_of(right, "right", kVermilion, 2.5)) curves.push_back(curve);
  for (std::size_t i = 0; i < curves.back().values.size(); ++i) curves.front().values.push_back(lines_of(i));
  double most = 0;
  for (const Curve& curve : curves) {
    most = std::max(most, *std::max_element(curve.values.begin(), curve.values.end()));
  }

  const Axis axis = axis_to(most);
  cv::Mat chart(kChartSize, CV_8UC3, kWhite);
  draw_axes(chart, axis);
  draw_legend(chart, curves);
  for (const Curve& curve : curves) draw_curve(chart, axis, curve);
  return encode_png(chart);
}

}  // namespace stereotlm::calib
