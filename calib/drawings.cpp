#include "calib/drawings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/canvas.h"
#include "calib/depth.h"

namespace stereotlm::calib {
namespace {

cv::Mat with_corners(const GridShape& shape, const kernels::GrayImage& image, const Corners& corners,
                     const std::vector<bool>& used) {
  constexpr int kSquare = 16;  // widths of the markers, pixels
  constexpr int kCross = 14;
  const cv::Scalar orange(0, 150, 255);
  const cv::Scalar red(0, 0, 255);
  cv::Mat picture = in_grey(image);
  cv::Mat2f points(shape.corners(), 1);
  for (int i = 0; i < shape.corners(); ++i) {
    const Eigen::Vector2f corner = corners[static_cast<std::size_t>(i)].cast<float>();
    points(i) = {corner.x(), corner.y()};
  }
  cv::drawChessboardCorners(picture, {shape.columns, shape.rows}, points, true);
  const auto mark = [&](int i, const cv::Scalar& color, cv::MarkerTypes marker, int width) {
    cv::drawMarker(picture, cv::Point2f(points(i)), color, marker, width, 2);
  };
  mark(0, orange, cv::MARKER_SQUARE, kSquare);
  for (int i = 0; i < shape.corners(); ++i) {
    if (!used[static_cast<std::size_t>(i)]) mark(i, red, cv::MARKER_TILTED_CROSS, kCross);
  }
  return picture;
}

cv::Mat with_rows(const kernels::GrayImage& image) {
  constexpr int kRows = 32;  // from line to line
  const cv::Scalar orange(0, 150, 255);
  const cv::Scalar cyan(220, 200, 0);
  cv::Mat picture = in_grey(image);
  for (int row = kRows / 2; row < picture.rows; row += kRows)
    picture.row(row) = row / kRows % 2 == 0 ? orange : cyan;
  return picture;
}

// What a table moves besides its offset.
struct Moves {
  cv::Point2d offset;  // the mean displacement from an entry to its source, in pixels
  cv::Mat2f moved;     // [entry]: the displacement less the offset
  cv::Mat1f lengths;   // of `moved`; NaN where the entry is not valid
  double largest = 0;  // of the lengths
};

Moves moves_of(const kernels::RectificationTable& table) {
  Moves moves;
  moves.moved = cv::Mat2f(table.height, table.width, cv::Vec2f());
  cv::Mat1b is_valid(table.height, table.width, std::uint8_t{0});
  auto entry = table.entries.begin();
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column, ++entry) {
      if (!kernels::entry_is_valid(*entry)) continue;
      is_valid(row, column) = 255;
      moves.moved(row, column) = {static_cast<float>(kernels::entry_column(*entry) - column),
                                  static_cast<float>(kernels::entry_row(*entry) - row)};
    }
  }
  const cv::Scalar mean = cv::mean(moves.moved, is_valid);
  moves.offset = {mean[0], mean[1]};
  cv::subtract(moves.moved, mean, moves.moved, is_valid);
  cv::Mat1f parts[2];
  cv::split(moves.moved, parts);
  cv::magnitude(parts[0], parts[1], moves.lengths);
  cv::minMaxLoc(moves.lengths, nullptr, &moves.largest);
  moves.lengths.setTo(std::numeric_limits<float>::quiet_NaN(), is_valid == 0);
  return moves;
}

constexpr int kSpacing = 40;  // of the arrows, in pixels

// `most`: the length of the brightest colour. `arrows`: the factor by which arrows are lengthened.
Panel displacement_panel(const std::string& name, const Moves& moves, double most, double arrows) {
  cv::Mat picture = in_colors(moves.lengths, 0, most);
  for (int row = kSpacing / 2; row < picture.rows; row += kSpacing) {
    for (int column = kSpacing / 2; column < picture.cols; column += kSpacing) {
      if (std::isnan(moves.lengths(row, column))) continue;
      const cv::Vec2f arrow = arrows * moves.moved(row, column);
      const cv::Point from(column, row);
      const cv::Point to(column + cvRound(arrow[0]), row + cvRound(arrow[1]));
      // White with a black edge, so that it is visible on every colour.
      cv::arrowedLine(picture, from, to, kBlack, 3, cv::LINE_AA, 0, 0.3);
      cv::arrowedLine(picture, from, to, kWhite, 1, cv::LINE_AA, 0, 0.3);
    }
  }
  const auto shown = [](double offset) { return std::round(10 * offset) / 10 + 0.0; };  // no "-0.0"
  return {fmt::format("{} without its offset ({:+.1f}, {:+.1f}) px; arrows {:.2g} times as long", name,
                      shown(moves.offset.x), shown(moves.offset.y), arrows),
          with_scale(picture, {"0", fmt::format("{:.1f} px", most), "no source"})};
}

std::vector<std::uint8_t> encode_displacement_png(const TablePair& tables) {
  constexpr double kLongest = 0.9 * kSpacing;
  constexpr double kLargestFactor = 100;
  const Moves left = moves_of(tables.left);
  const Moves right = moves_of(tables.right);
  const double most = std::max(left.largest, right.largest);
  const double arrows = std::min(kLargestFactor, kLongest / std::max(most, 1e-9));
  return encode_panels_png({displacement_panel("left table", left, most, arrows),
                            displacement_panel("right table", right, most, arrows)});
}

}  // namespace

std::map<std::string, std::vector<std::uint8_t>> drawings(const CalibrationRequest& request,
                                                          const CalibrationResult& result) {
  std::map<std::string, std::vector<std::uint8_t>> files;
  for (const CalibratedPair& pair : result.pairs) {
    const PicturePair& pictures = request.pictures[pair.picture];
    const std::string left = std::filesystem::path(pictures.left_name).filename();
    const std::string right = std::filesystem::path(pictures.right_name).filename();
    files[fmt::format("corners_{:02}.png", pair.picture)] = encode_panels_png(
        {{left, with_corners(request.grid, pictures.left, pair.corners.left, pair.used)},
         {right, with_corners(request.grid, pictures.right, pair.corners.right, pair.used)}});
    files[fmt::format("rectified_{:02}.png", pair.picture)] =
        encode_panels_png({{left, with_rows(kernels::rectify(pictures.left, result.tables.left))},
                           {right, with_rows(kernels::rectify(pictures.right, result.tables.right))}});
  }
  files["displacement.png"] = encode_displacement_png(result.tables);
  return files;
}

std::vector<std::uint8_t> encode_depth_color_png(int width, int height,
                                                 const std::vector<std::uint16_t>& millimetres) {
  const DepthRange shown = depth_range(millimetres).value_or(DepthRange{0, 1});
  cv::Mat1f depths(height, width);
  std::transform(millimetres.begin(), millimetres.end(), depths.begin(), [](int depth) {
    return depth > 0 ? static_cast<float>(depth) : std::numeric_limits<float>::quiet_NaN();
  });
  return encode_png(
      with_scale(in_colors(depths, shown.far_mm, shown.near_mm),
                 {fmt::format("{} mm", shown.far_mm), fmt::format("{} mm", shown.near_mm), "unknown"}));
}

}  // namespace stereotlm::calib
