#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "calib/canvas.h"
#include "calib/drawings.h"
#include "calib/source_lines.h"

namespace stereotlm::calib {
namespace {

constexpr int kMostLines = 31;
constexpr int kTickLength = 5;  // pixels
const cv::Size kChartSize(800, 500);
const cv::Rect kPlot(52, 68, 724, 372);  // inside the axes
const cv::Scalar kGridColor(221, 221, 221);

enum class Mark { kNone, kRing, kDisc };

struct Curve {
  std::string name;
  cv::Scalar color;
  int thickness = 1;  // pixels
  Mark mark = Mark::kNone;
  std::vector<double> values;  // [i]: for lines_of(i)
};

int lines_of(std::size_t index) { return 1 + 2 * static_cast<int>(index); }

// Two curves of source_lines(): the largest number in the picture, and the mean.
std::vector<Curve> curves_of(const kernels::RectificationTable& table, const std::string& side,
                             const cv::Scalar& color, Mark mark) {
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

// The vertical axis: from 0 to a multiple of the step, which is 1, 2 or 5 times a power of ten.
struct Axis {
  int step = 1;
  int end = 1;
};

Axis axis_to(double most) {
  constexpr int kMostSteps = 10;
  for (int power = 1;; power *= 10) {
    for (const int digit : {1, 2, 5}) {
      const int step = digit * power;
      const int steps = std::max(1, cvCeil(most / step));
      if (steps <= kMostSteps) return {step, steps * step};
    }
  }
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
  const cv::Point origin(kPlot.x, kPlot.br().y);
  cv::line(chart, {kPlot.x, kPlot.y}, origin, kBlack);
  cv::line(chart, origin, {kPlot.br().x, origin.y}, kBlack);
}

void draw_titles(cv::Mat& chart) {
  draw_text(chart,
            "Lines of the camera's picture, from first to last, that n rows of the rectified picture take "
            "pixels from",
            {12, 24});
  const std::string below = "n, rows of the rectified picture";
  draw_text(chart, below, {kPlot.x + (kPlot.width - text_width(below)) / 2, kChartSize.height - 14});
}

void draw_mark(cv::Mat& chart, const cv::Point2d& middle, const Curve& curve) {
  if (curve.mark == Mark::kRing) draw_circle(chart, middle, 5, curve.color);
  if (curve.mark == Mark::kDisc) draw_circle(chart, middle, 2.5, curve.color, cv::FILLED);
}

void draw_curve(cv::Mat& chart, const Axis& axis, const Curve& curve) {
  for (std::size_t i = 0; i < curve.values.size(); ++i) {
    const cv::Point2d point = place(axis, lines_of(i), curve.values[i]);
    if (i > 0) {
      draw_line(chart, place(axis, lines_of(i - 1), curve.values[i - 1]), point, curve.color,
                curve.thickness);
    }
    draw_mark(chart, point, curve);
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
    draw_mark(chart, middle, curve);
    draw_text(chart, curve.name, {left + kSample + 6, bottom});
    left += kSample + 6 + text_width(curve.name) + 20;
  }
}

}  // namespace

std::vector<std::uint8_t> encode_source_lines_png(const kernels::RectificationTable& left,
                                                  const kernels::RectificationTable& right) {
  check_tables(left, right);
  std::vector<Curve> curves = {{"n", kGray, 1, Mark::kNone, {}}};
  for (const Curve& curve : curves_of(left, "left", kBlue, Mark::kRing)) curves.push_back(curve);
  for (const Curve& curve : curves_of(right, "right", kVermilion, Mark::kDisc)) curves.push_back(curve);
  for (std::size_t i = 0; i < curves.back().values.size(); ++i) curves.front().values.push_back(lines_of(i));
  double most = 0;
  for (const Curve& curve : curves) {
    most = std::max(most, *std::max_element(curve.values.begin(), curve.values.end()));
  }

  const Axis axis = axis_to(most);
  cv::Mat chart(kChartSize, CV_8UC3, kWhite);
  draw_axes(chart, axis);
  draw_titles(chart);
  draw_legend(chart, curves);
  for (const Curve& curve : curves) draw_curve(chart, axis, curve);
  return encode_png(chart);
}

}  // namespace stereotlm::calib
