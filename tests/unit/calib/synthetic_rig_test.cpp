#include "tests/support/synthetic_rig.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

// calibrate_test.cpp finds the grids and the matches in the pictures: the rig and the disparities are
// recovered.
namespace stereotlm::test {
namespace {

using namespace calib;
using Eigen::Vector2d;
using Eigen::Vector3d;

bool in_picture(const Vector2d& pixel, const Rig& rig) {
  return pixel.x() >= 0 && pixel.x() <= rig.width - 1 && pixel.y() >= 0 && pixel.y() <= rig.height - 1;
}

// A point inside the right camera's view that it does not see has a nearer point in front of it.
TEST(SyntheticRig, HasNoMatchForHiddenPoints) {
  const SyntheticRig rig(3, 160, 120);
  const Vector3d eye = -(rig.rig().rotation.transpose() * rig.rig().translation);
  struct Hidden {
    Vector2d right;
    double distance;
  };
  std::vector<Hidden> hidden;
  cv::Mat nearest(120, 160, CV_64F, cv::Scalar(1e9));  // of the matches, at their pixel of the right picture
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const Vector3d point = rig.point({x, y}).value();
      const double distance = (point - eye).norm();
      const Vector2d right = seen_by(rig.rig(), point).right;
      if (!in_picture(right, rig.rig())) continue;
      if (rig.match({x, y})) {
        double& found = nearest.at<double>(cvRound(right.y()), cvRound(right.x()));
        found = std::min(found, distance);
      } else {
        hidden.push_back({right, distance});
      }
    }
  }
  ASSERT_GT(hidden.size(), 100U);
  cv::Mat around;
  cv::erode(nearest, around, cv::Mat::ones(3, 3, CV_8U));
  const auto explained = std::count_if(hidden.begin(), hidden.end(), [&around](const Hidden& point) {
    return around.at<double>(cvRound(point.right.y()), cvRound(point.right.x())) < point.distance - 100;
  });
  EXPECT_GT(static_cast<double>(explained), 0.97 * static_cast<double>(hidden.size()));
}

// With the true calibration a match lies in the same row, and Q gives the depth from its disparity.
TEST(SyntheticRig, HasTheDisparityOfTheDepth) {
  const SyntheticRig synthetic(4, 160, 120);
  const Rig& rig = synthetic.rig();
  const Rectification ideal = rectify(rig);
  const std::vector<float> disparity = synthetic.disparity(rig, ideal, 0);
  ASSERT_EQ(disparity.size(), 160U * 120U);
  int found = 0;
  float least = 1000, most = 0;
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      const float d = disparity[static_cast<std::size_t>(v * 160 + u)];
      const Vector2d left = *SourcePixels(rig.left, ideal.r1, ideal.p1).at({u, v});
      const auto right = synthetic.match(left);
      ASSERT_EQ(std::isnan(d), !right);
      if (!right) continue;
      ++found;
      least = std::min(least, d);
      most = std::max(most, d);
      EXPECT_NEAR(rectified_pixel(rig.right, ideal.r2, ideal.p2, *right).y(), v, 1e-6);
      const Eigen::Vector4d point = ideal.q * Eigen::Vector4d(u, v, d, 1);
      const Vector3d expected = ideal.r1 * *synthetic.point(left);
      EXPECT_LT((point.hnormalized() - expected).norm(), 1e-5 * expected.norm());
    }
  }
  EXPECT_GT(found, 0.8 * 160 * 120);
  EXPECT_NEAR(least, 160 / 34.0, 160 / 200.0);
  EXPECT_NEAR(most, 160 / 9.5, 160 / 100.0);
}

}  // namespace
}  // namespace stereotlm::test
