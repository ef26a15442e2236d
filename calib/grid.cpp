#include "calib/grid.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

std::size_t index_of(const GridShape& shape, int column, int row) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(shape.columns) +
         static_cast<std::size_t>(column);
}

double smallest_spacing(const GridShape& shape, const Corners& corners) {
  double smallest = std::numeric_limits<double>::infinity();
  const auto columns = static_cast<std::size_t>(shape.columns);
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (i % columns != 0) smallest = std::min(smallest, (corners[i] - corners[i - 1]).norm());
    if (i >= columns) smallest = std::min(smallest, (corners[i] - corners[i - columns]).norm());
  }
  return smallest;
}

// Reduces a picture whose longer side exceeds `longest` pixels, which bounds the time of a search. Returns
// the factor, 0..1.
double reduce(const kernels::GrayImage& picture, int longest, cv::Mat& reduced) {
  const double scale = std::min(1.0, static_cast<double>(longest) / std::max(picture.width, picture.height));
  cv::resize(view(picture), reduced, {}, scale, scale, cv::INTER_AREA);
  return scale;
}

// The corners at these points of a picture that was reduced by the factor `scale`.
Corners to_corners(const std::vector<cv::Point2f>& points, double scale = 1) {
  Corners corners;
  for (const cv::Point2f& point : points)
    corners.emplace_back((point.x + 0.5) / scale - 0.5, (point.y + 0.5) / scale - 0.5);
  return corners;
}

// The corners of a grid, of which OpenCV took the columns for the rows: those of a grid turned by 90 degrees.
// The corner (column, row) is at (row, last - column).
template <typename Point>
std::vector<Point> turned_by_quarter(const GridShape& shape, const std::vector<Point>& corners) {
  std::vector<Point> turned;
  for (int row = 0; row < shape.rows; ++row) {
    for (int column = 0; column < shape.columns; ++column) {
      turned.push_back(corners[static_cast<std::size_t>((shape.columns - 1 - column) * shape.rows + row)]);
    }
  }
  return turned;
}

// How well the directions of the rows and columns of `a` and `b` agree: 2 if both are the same, -2 if both
// are opposite.
double agreement(const GridShape& shape, const Corners& a, const Corners& b) {
  const auto along = [&shape](const Corners& corners, int column, int row) -> Eigen::Vector2d {
    return (corners[index_of(shape, column, row)] - corners.front()).normalized();
  };
  const int last_column = shape.columns - 1;
  const int last_row = shape.rows - 1;
  return along(a, last_column, 0).dot(along(b, last_column, 0)) +
         along(a, 0, last_row).dot(along(b, 0, last_row));
}

// The mean grey of the 3 x 3 pixels around a position. Pixels outside the picture are left out.
double grey_at(const kernels::GrayImage& picture, const Eigen::Vector2d& position) {
  const cv::Rect around(cvRound(position.x()) - 1, cvRound(position.y()) - 1, 3, 3);
  const cv::Rect inside = around & cv::Rect(0, 0, picture.width, picture.height);
  return inside.empty() ? 0 : cv::mean(view(picture)(inside))[0];
}

// By how much two opposite squares at a corner are brighter than the other two. `right` and `down` lead to
// the next corners.
double contrast(const kernels::GrayImage& picture, const Eigen::Vector2d& corner,
                const Eigen::Vector2d& right, const Eigen::Vector2d& down) {
  constexpr double kReach = 0.35;  // of a square
  const Eigen::Vector2d falling = kReach * (right + down);
  const Eigen::Vector2d rising = kReach * (right - down);
  return grey_at(picture, corner + falling) + grey_at(picture, corner - falling) -
         grey_at(picture, corner + rising) - grey_at(picture, corner - rising);
}

// The checks of are_all_of_board().
class BoardCheck {
 public:
  BoardCheck(const kernels::GrayImage& picture, const GridShape& shape, const Corners& corners)
      : picture_(picture), shape_(shape), corners_(corners) {
    std::vector<cv::Point2d> on_board;
    std::vector<cv::Point2d> seen;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto [row, column] = std::div(static_cast<int>(i), shape.columns);
      on_board.emplace_back(column, row);
      seen.emplace_back(corners[i].x(), corners[i].y());
    }
    without_lens_ = to_eigen<Eigen::Matrix3d>(cv::findHomography(on_board, seen));
  }

  // Whether the sign of the contrast alternates from corner to corner, as on a chessboard. It does not if a
  // line of corners inside the board was missed.
  bool alternate() const {
    constexpr double kAtLeast = 0.9;  // single corners may be hard to see
    double sum = 0;
    double most = 0;
    for (int row = 0; row < shape_.rows; ++row) {
      for (int column = 0; column < shape_.columns; ++column) {
        const double here = contrast_at(column, row);
        sum += (column + row) % 2 == 0 ? here : -here;
        most += std::abs(here);
      }
    }
    return std::abs(sum) > kAtLeast * most;
  }

  // Whether the board has further lines of corners outside the lines found. If not, a point one square
  // outside lies at the edge of the board. It has squares on one side only, so half the contrast of a corner.
  bool continue_outside() const {
    constexpr double kAtLeast = 0.72;
    const auto exceeds = [](double beyond, double within) {
      return beyond * within < 0 && std::abs(beyond) > kAtLeast * std::abs(within);
    };
    for (const bool is_row : {false, true}) {
      const int last = (is_row ? shape_.rows : shape_.columns) - 1;
      if (exceeds(contrast_of_line(is_row, -1), contrast_of_line(is_row, 0)) ||
          exceeds(contrast_of_line(is_row, last + 1), contrast_of_line(is_row, last)))
        return true;
    }
    return false;
  }

 private:
  // The position of a corner. Outside the corners found, it is extrapolated in the plane of the board, and
  // shifted by the distortion of the nearest corner found.
  Eigen::Vector2d corner(int column, int row) const {
    const int inner_column = std::clamp(column, 0, shape_.columns - 1);
    const int inner_row = std::clamp(row, 0, shape_.rows - 1);
    const Eigen::Vector2d& inner = corners_[index_of(shape_, inner_column, inner_row)];
    return inner + corner_without_lens(column, row) - corner_without_lens(inner_column, inner_row);
  }

  Eigen::Vector2d corner_without_lens(int column, int row) const {
    return (without_lens_ * Eigen::Vector3d(column, row, 1)).hnormalized();
  }

  double contrast_at(int column, int row) const {
    const int next_column = column + 1 < shape_.columns ? 1 : -1;
    const int next_row = row + 1 < shape_.rows ? 1 : -1;
    const Eigen::Vector2d here = corner(column, row);
    const Eigen::Vector2d right = next_column * (corner(column + next_column, row) - here);
    const Eigen::Vector2d down = next_row * (corner(column, row + next_row) - here);
    return contrast(picture_, here, right, down);
  }

  // The contrast of a row or a column of corners, whose signs alternate.
  double contrast_of_line(bool is_row, int line) const {
    double sum = 0;
    for (int i = 0; i < (is_row ? shape_.columns : shape_.rows); ++i)
      sum += (i % 2 == 0 ? 1 : -1) * (is_row ? contrast_at(i, line) : contrast_at(line, i));
    return sum;
  }

  const kernels::GrayImage& picture_;
  const GridShape& shape_;
  const Corners& corners_;
  Eigen::Matrix3d without_lens_;  // homography from columns and rows of corners to pixels
};

// The corners of the chessboard to a few pixels. The first detector, of quadrangles, searches a reduced
// picture. Its adaptive thresholds take seconds if they find no chessboard, so they are used only where
// thresholds for the whole picture, which take less than 0.1 s, have found one. The second detector, of
// Duda and Frese (2018), finds chessboards that are blurred, grainy or small, and takes 0.6 s at most.
std::optional<Corners> roughly_found(const kernels::GrayImage& picture, const GridShape& shape) {
  constexpr int kLongestSide = 640;
  cv::Mat reduced;
  const double scale = reduce(picture, kLongestSide, reduced);
  const cv::Size size(shape.columns, shape.rows);
  std::vector<cv::Point2f> points;
  const auto is_found = [&](int flags) { return cv::findChessboardCorners(reduced, size, points, flags); };
  if (is_found(cv::CALIB_CB_FAST_CHECK) &&
      is_found(cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
    return to_corners(points, scale);
  if (cv::findChessboardCornersSB(view(picture), size, points)) return to_corners(points);
  return std::nullopt;
}

// The circles of the grid among dots, at the positions of the dots.
std::optional<std::vector<cv::Point2f>> circles_among(const std::vector<cv::Point2f>& dots,
                                                      const GridShape& shape) {
  if (dots.size() < static_cast<std::size_t>(shape.corners())) return std::nullopt;
  const bool is_symmetric = shape.pattern == Pattern::kCircles;
  const int flags = is_symmetric ? cv::CALIB_CB_SYMMETRIC_GRID : cv::CALIB_CB_ASYMMETRIC_GRID;
  std::vector<cv::Point2f> circles;
  const auto are_found = [&](const cv::Size& size) {
    return cv::findCirclesGrid(dots, size, circles, flags, cv::Ptr<cv::FeatureDetector>());
  };
  if (are_found({shape.columns, shape.rows})) return circles;
  // OpenCV takes the more horizontal lines of a symmetric grid for its rows.
  if (is_symmetric && are_found({shape.rows, shape.columns})) return turned_by_quarter(shape, circles);
  return std::nullopt;
}

GridSearch find_circles(const kernels::GrayImage& picture, const GridShape& shape) {
  constexpr int kLongestSide = 1280;
  constexpr std::size_t kMostDots = 400;  // the search takes 2 s with them, and the cube of their number
  cv::Mat reduced;
  const double scale = reduce(picture, kLongestSide, reduced);
  cv::SimpleBlobDetector::Params limits;
  limits.maxArea = static_cast<float>(reduced.total()) / static_cast<float>(shape.corners());
  std::vector<cv::KeyPoint> found;
  cv::SimpleBlobDetector::create(limits)->detect(reduced, found);
  std::vector<cv::Point2f> dots;
  cv::KeyPoint::convert(found, dots);
  if (dots.size() > kMostDots) {
    return {std::nullopt, fmt::format("{} dark dots: must be {} at most, to find a grid of {} among them",
                                      dots.size(), kMostDots, shape.text())};
  }
  const auto circles = circles_among(dots, shape);
  if (!circles) return {std::nullopt, fmt::format("no grid of {} found", shape.text())};
  const auto is_larger = [&](int columns, int rows) {
    return circles_among(dots, {columns, rows, shape.square_mm, shape.pattern}).has_value();
  };
  if (is_larger(shape.columns + 1, shape.rows) || is_larger(shape.columns, shape.rows + 1))
    return {std::nullopt, fmt::format("the grid has more than {}", shape.text())};
  return {to_corners(*circles, scale), ""};
}

}  // namespace

GridSearch find_grid(const kernels::GrayImage& picture, const GridShape& shape) {
  constexpr int kSmallest = 16;  // pixels each way: the least that OpenCV's search accepts
  const std::string none = fmt::format("no grid of {} found", shape.text());
  if (std::min(picture.width, picture.height) < kSmallest) return {std::nullopt, none};
  if (shape.pattern != Pattern::kChessboard) return find_circles(picture, shape);
  const std::optional<Corners> found = roughly_found(picture, shape);
  if (!found) return {std::nullopt, none};
  const Corners corners = refined(picture, shape, *found);
  if (!are_all_of_board(picture, shape, corners)) {
    return {std::nullopt, fmt::format("the grid has more than {}, or is not seen well", shape.text())};
  }
  return {corners, ""};
}

std::optional<Corners> found_near(const kernels::GrayImage& picture, const GridShape& shape,
                                  const Corners& near) {
  if (shape.pattern == Pattern::kChessboard) return refined(picture, shape, near);
  const GridSearch found = find_grid(picture, shape);
  if (!found.corners) return std::nullopt;
  return ordered_like(near, shape, *found.corners);
}

bool are_all_of_board(const kernels::GrayImage& picture, const GridShape& shape, const Corners& corners) {
  const BoardCheck check(picture, shape, corners);
  return check.alternate() && !check.continue_outside();
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
  if (shape.pattern == Pattern::kAsymmetricCircles) return corners;
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
