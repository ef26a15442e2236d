#include "calib/grid.h"

#include <algorithm>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calib/opencv_types.h"

namespace stereotlm::calib {
namespace {

std::size_t index_of(const GridShape& shape, int column, int row) {
  return static_cast<std::size_t>(row * shape.columns + column);
}

double smallest_spacing(const GridShape& shape, const Corners& corners) {
  double smallest = std::numeric_limits<double>::infinity();
  const auto compare = [&](std::size_t a, std::size_t b) {
    smallest = std::min(smallest, (corners[a] - corners[b]).norm());
  };
  for (int row = 0; row < shape.rows; ++row) {
    for (int column = 0; column < shape.columns; ++column) {
      const std::size_t here = index_of(shape, column, row);
      if (column + 1 < shape.columns) compare(here, index_of(shape, column + 1, row));
      if (row + 1 < shape.rows) compare(here, index_of(shape, column, row + 1));
    }
  }
  return smallest;
}

Corners to_corners(const std::vector<cv::Point2f>& points) {
  Corners corners;
  for (const cv::Point2f& point : points) corners.emplace_back(point.x, point.y);
  return corners;
}

// Of a square board, turned by a quarter: (column, row) is seen at (row, last - column).
Corners turned_by_quarter(const GridShape& shape, const Corners& corners) {
  Corners turned;
  for (int row = 0; row < shape.rows; ++row) {
    for (int column = 0; column < shape.columns; ++column) {
      turned.push_back(corners[index_of(shape, row, shape.columns - 1 - column)]);
    }
  }
  return turned;
}

// How far the rows and columns of both run in the same directions.
double agreement(const GridShape& shape, const Corners& a, const Corners& b) {
  const auto along = [&shape](const Corners& corners, int column, int row) -> Eigen::Vector2d {
    return (corners[index_of(shape, column, row)] - corners.front()).normalized();
  };
  const int last_column = shape.columns - 1;
  const int last_row = shape.rows - 1;
  return along(a, last_column, 0).dot(along(b, last_column, 0)) +
         along(a, 0, last_row).dot(along(b, 0, last_row));
}

}  // namespace

std::optional<Corners> find_grid(const kernels::GrayImage& picture, const GridShape& shape) {
  std::vector<cv::Point2f> points;
  if (!cv::findChessboardCorners(view(picture), {shape.columns, shape.rows}, points,
                                 cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return std::nullopt;
  }
  return refined(picture, shape, to_corners(points));
}

Corners refined(const kernels::GrayImage& picture, const GridShape& shape, const Corners& corners) {
  constexpr double kShareOfSpacing = 0.3;
  constexpr int kSmallestWindow = 2;  // pixels to every side
  const int reach =
      std::max(kSmallestWindow, static_cast<int>(kShareOfSpacing * smallest_spacing(shape, corners)));
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& corner : corners) {
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  }
  constexpr int kMostSteps = 100;
  constexpr double kCloseEnough = 1e-4;  // pixels
  const cv::Size no_dead_zone(-1, -1);
  cv::cornerSubPix(view(picture), points, {reach, reach}, no_dead_zone,
                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kMostSteps, kCloseEnough});
  return to_corners(points);
}

Corners ordered_like(const Corners& other, const GridShape& shape, const Corners& corners) {
  std::vector<Corners> orders = {corners, Corners(corners.rbegin(), corners.rend())};
  if (shape.columns == shape.rows) {
    orders.push_back(turned_by_quarter(shape, corners));
    orders.emplace_back(orders.back().rbegin(), orders.back().rend());
  }
  return *std::max_element(orders.begin(), orders.end(), [&](const Corners& a, const Corners& b) {
    return agreement(shape, other, a) < agreement(shape, other, b);
  });
}

}  // namespace stereotlm::calib
