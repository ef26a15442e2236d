#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "calib/canvas.h"
#include "calib/drawings.h"

namespace stereotlm::calib {
namespace {

constexpr int kSpacing = 40;  // of the arrows in pixels of the drawing, at most

bool is_valid(const kernels::RectificationTable& table, int column, int row) {
  return kernels::entry_is_valid(
      table.entries[static_cast<std::size_t>(row) * static_cast<std::size_t>(table.width) +
                    static_cast<std::size_t>(column)]);
}

// From the position of a valid entry to its source.
cv::Point2d displacement(const kernels::RectificationTable& table, int column, int row) {
  const std::uint32_t entry =
      table.entries[static_cast<std::size_t>(row) * static_cast<std::size_t>(table.width) +
                    static_cast<std::size_t>(column)];
  return {kernels::entry_column(entry) - static_cast<double>(column),
          kernels::entry_row(entry) - static_cast<double>(row)};
}

// The mean of all displacements: what the table moves the whole picture by.
cv::Point2d offset_of(const kernels::RectificationTable& table) {
  cv::Point2d sum;
  int count = 0;
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column) {
      if (!is_valid(table, column, row)) continue;
      sum += displacement(table, column, row);
      ++count;
    }
  }
  return sum / std::max(count, 1);
}

// The length of each displacement without the offset, in pixels; NaN where the entry is not valid.
cv::Mat1f lengths(const kernels::RectificationTable& table, const cv::Point2d& offset) {
  cv::Mat1f result(table.height, table.width, std::numeric_limits<float>::quiet_NaN());
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column) {
      if (is_valid(table, column, row))
        result(row, column) = static_cast<float>(cv::norm(displacement(table, column, row) - offset));
    }
  }
  return result;
}

double largest(const cv::Mat1f& lengths) {
  double most = 0;
  for (const float length : lengths) {
    if (!std::isnan(length)) most = std::max(most, static_cast<double>(length));
  }
  return most;
}

// The factor by which arrows are lengthened so that none reaches the next position: 1, 2 or 5 times a power of ten.
// `most`: the length of the longest one, in pixels of the drawing.
double arrow_factor(double most, int spacing) {
  constexpr double kShareOfSpacing = 0.9;
  constexpr double kLargest = 100;
  const double fits = std::min(kLargest, kShareOfSpacing * spacing / std::max(most, 1e-9));
  const double power = std::pow(10, std::floor(std::log10(fits) + 1e-9));
  for (const double digit : {5.0, 2.0}) {
    if (digit * power <= fits) return digit * power;
  }
  return power;
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

struct Side {
  cv::Point2d offset;
  cv::Mat1f lengths;
};

Side side_of(const kernels::RectificationTable& table) {
  const cv::Point2d offset = offset_of(table);
  return {offset, lengths(table, offset)};
}

cv::Mat drawn(const kernels::RectificationTable& table, const Side& side, double most, double arrows) {
  const int factor = enlargement({table.width, table.height});
  cv::Mat panel;
  cv::resize(in_colors(side.lengths, 0, most), panel, {}, factor, factor, cv::INTER_NEAREST);
  const int spacing = std::max(1, kSpacing / factor);
  for (int row = spacing / 2; row < table.height; row += spacing) {
    for (int column = spacing / 2; column < table.width; column += spacing) {
      if (!is_valid(table, column, row)) continue;
      const cv::Point2d from = enlarged(cv::Point2d(column, row), factor);
      draw_arrow(panel, from, from + (displacement(table, column, row) - side.offset) * factor * arrows);
    }
  }
  return panel;
}

std::string caption(const std::string& name, const Side& side, double arrows) {
  return fmt::format("{} without its offset ({:+.1f}, {:+.1f}) px; arrows {:g} times as long", name,
                     side.offset.x, side.offset.y, arrows);
}

}  // namespace

std::vector<std::uint8_t> encode_displacement_png(const kernels::RectificationTable& left,
                                                  const kernels::RectificationTable& right) {
  check_tables(left, right);
  const Side of_left = side_of(left);
  const Side of_right = side_of(right);
  const double most = std::max(largest(of_left.lengths), largest(of_right.lengths));
  const int factor = enlargement({left.width, left.height});
  const double arrows = arrow_factor(most * factor, std::max(1, kSpacing / factor) * factor);
  Pair pair = side_by_side(caption("left table", of_left, arrows), drawn(left, of_left, most, arrows),
                           caption("right table", of_right, arrows), drawn(right, of_right, most, arrows),
                           kScaleHeight);
  draw_color_scale(pair.canvas, {pair.left.x, pair.left.br().y + kScaleHeight - 4}, pair.left.width, "0",
                   fmt::format("{:.1f} px", most), "no source");
  return encode_png(pair.canvas);
}

}  // namespace stereotlm::calib
