#include "tests/support/synthetic_rig.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

// calibrate_test.cpp finds the grids and the matches in the pictures: the rig and the disparities are
// recovered.
namespace stereotlm::test {
namespace {

using namespace calib;
using Eigen::Vector2d;
using Eigen::Vector3d;

bool in_picture(const Vector2d& pixel, const Rig& rig, double margin = 0) {
  return pixel.x() >= margin && pixel.x() <= rig.width - 1 - margin && pixel.y() >= margin &&
         pixel.y() <= rig.height - 1 - margin;
}

// A rig that differs a little from the true one.
Rig recovered(const Rig& rig) {
  Rig result = rig;
  result.left.matrix(0, 0) += 1.5;
  result.left.matrix(0, 2) -= 1.2;
  result.right.matrix(1, 2) += 0.8;
  result.right.distortion[0] += 0.004;
  result.rotation = Eigen::AngleAxisd(0.002, Vector3d::UnitY()).toRotationMatrix() * rig.rotation;
  return result;
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

TEST(SyntheticRig, HasNoMatchOutsideThePictures) {
  const SyntheticRig rig(3, 160, 120);
  for (const Vector2d& outside :
       {Vector2d(-0.6, 60), Vector2d(159.6, 60), Vector2d(80, -0.6), Vector2d(80, 119.6)}) {
    EXPECT_FALSE(rig.point(outside));
    EXPECT_FALSE(rig.match(outside));
  }
  for (const Vector2d& inside :
       {Vector2d(-0.4, 60), Vector2d(159.4, 60), Vector2d(80, -0.4), Vector2d(80, 119.4)}) {
    EXPECT_TRUE(rig.point(inside));
  }
  int unseen = 0;
  for (int y = 0; y < 120; y += 4) {
    for (int x = 0; x < 160; ++x) {
      const Vector2d right = seen_by(rig.rig(), rig.point({x, y}).value()).right;
      if (in_picture(right, rig.rig(), -0.5)) continue;
      EXPECT_FALSE(rig.match({x, y}));
      ++unseen;
    }
  }
  EXPECT_GT(unseen, 0);
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

TEST(SyntheticRig, HasTheDisparityOfARecoveredCalibrationWithAnOffset) {
  const SyntheticRig synthetic(4, 80, 60);
  const Rig rig = recovered(synthetic.rig());
  const Rectification ideal = rectify(rig);
  const std::vector<float> disparity = synthetic.disparity(rig, ideal, 3);
  int found = 0;
  for (int v = 0; v < 60; ++v) {
    for (int u = 0; u < 80; ++u) {
      const auto i = static_cast<std::size_t>(v * 80 + u);
      const auto right = synthetic.match(*SourcePixels(rig.left, ideal.r1, ideal.p1).at({u + 3, v}));
      ASSERT_EQ(std::isnan(disparity[i]), !right);
      if (!right) continue;
      ++found;
      const double expected = u - rectified_pixel(rig.right, ideal.r2, ideal.p2, *right).x();
      EXPECT_NEAR(disparity[i], expected, 1e-5);
    }
  }
  EXPECT_GT(found, 3000);
}

}  // namespace
}  // namespace stereotlm::test
