#include "calib/matched_rows.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

constexpr int kMostPoints = 150;
constexpr int kReach = 7;     // pixels of the window to each side of a point
constexpr int kMostRows = 8;  // rows that are searched above and below
constexpr float kLeastCorrelation = 0.9F;

// The position of the maximum of a parabola through three values, from the middle one, which is the largest:
// -0.5..0.5.
double between(double before, double largest, double after) {
  const double bend = before - 2 * largest + after;
  return bend < 0 ? 0.5 * (before - after) / bend : 0;
}

}  // namespace

MatchedRows matched_rows(const kernels::GrayImage& left, const kernels::GrayImage& right, int disparities) {
  if (left.width != right.width || left.height != right.height) {
    throw std::invalid_argument("right picture = " + std::to_string(right.width) + "x" +
                                std::to_string(right.height) + ": must be as large as the left one, " +
                                std::to_string(left.width) + "x" + std::to_string(left.height));
  }
  constexpr double kQuality = 0.02;
  constexpr double kDistance = 16;
  std::vector<cv::Point2f> points;
  cv::goodFeaturesToTrack(view(left), points, kMostPoints, kQuality, kDistance);
  const cv::Rect picture(0, 0, left.width, left.height);
  MatchedRows result;
  RowErrors errors;
  for (const cv::Point2f& point : points) {
    const int column = cvRound(point.x);
    const int row = cvRound(point.y);
    const cv::Rect window(column - kReach, row - kReach, 2 * kReach + 1, 2 * kReach + 1);
    const cv::Rect searched(window.x - (disparities - 1), window.y - kMostRows,
                            window.width + disparities - 1, window.height + 2 * kMostRows);
    const cv::Rect inside = searched & picture;
    if ((window & picture) != window || inside.height != searched.height || inside.width < window.width)
      continue;
    ++result.points;
    cv::Mat likeness;
    cv::matchTemplate(view(right)(inside), view(left)(window), likeness, cv::TM_CCOEFF_NORMED);
    double largest = 0;
    cv::Point at;
    cv::minMaxLoc(likeness, nullptr, &largest, nullptr, &at);
    if (!(largest >= kLeastCorrelation) || at.y == 0 || at.y == likeness.rows - 1) continue;
    const double rest =
        between(likeness.at<float>(at.y - 1, at.x), largest, likeness.at<float>(at.y + 1, at.x));
    const double found = inside.y + at.y + rest;
    errors.add({0, window.y}, {0, found});
  }
  result.error = errors.result();
  return result;
}

}  // namespace stereotlm::calib
