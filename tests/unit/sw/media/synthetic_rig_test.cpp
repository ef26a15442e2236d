#include "sw/media/synthetic_rig.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

// tests/unit/calib/calibrate_test.cpp recovers the rig and the disparities from the pictures.
namespace stereotlm::media {
namespace {

using calib::GridPair;
using calib::GridShape;
using calib::Rectification;
using calib::Rig;
using calib::seen_by;
using calib::SourcePixels;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr GridShape kGrid = {9, 6, 25};
constexpr int kViews = 12;

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

TEST(SyntheticRig, IsTheSameForASeedAndDiffersBetweenSeeds) {
  const SyntheticRig a(5, 64, 48);
  const SyntheticRig b(5, 64, 48);
  EXPECT_EQ(a.scene().right, b.scene().right);
  EXPECT_EQ(a.grid_view(kGrid, 3).right, b.grid_view(kGrid, 3).right);
  const SyntheticRig other(6, 64, 48);
  EXPECT_NE(a.rig().left.matrix, other.rig().left.matrix);
  EXPECT_NE(a.rig().right.distortion, other.rig().right.distortion);
  EXPECT_NE(a.rig().rotation, other.rig().rotation);
  EXPECT_NE(a.scene().left, other.scene().left);
  EXPECT_NE(a.grid_view(kGrid, 0).left, other.grid_view(kGrid, 0).left);
}

TEST(SyntheticRig, HasCamerasWithinTheStatedBounds) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Rig rig = SyntheticRig(seed, 64, 48).rig();
    EXPECT_EQ(rig.width, 64);
    EXPECT_EQ(rig.height, 48);
    EXPECT_NE(rig.left.matrix, rig.right.matrix);
    EXPECT_NEAR(rig.left.matrix(0, 0), 0.83 * 64, 0.03 * 0.83 * 64);
    EXPECT_NEAR(rig.left.matrix(0, 2), 31.5, 0.04 * 64);
    EXPECT_NEAR(rig.left.distortion[0], -0.28, 0.02);
    EXPECT_NEAR(rig.translation.norm(), 80, 3);
    EXPECT_LT(rig.translation.x(), -70);
    EXPECT_NEAR((rig.rotation * rig.rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
    const double turned = Eigen::AngleAxisd(rig.rotation).angle();
    EXPECT_GT(turned, 0.001);
    EXPECT_LT(turned, 0.046);
  }
}

// The only row of one camera's picture shows nothing of the other's.
TEST(SyntheticRig, RefusesAGridThatFindsNoPlace) {
  const SyntheticRig rig(2, 2048, 1);
  EXPECT_THROW(rig.grid_view(kGrid, 0), std::domain_error);
  EXPECT_THROW(rig.grid_corners(kGrid, 0), std::domain_error);
}

TEST(SyntheticRig, ShowsEveryCornerToBothCameras) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const SyntheticRig rig(seed, 320, 240);
    for (const GridShape& shape : {kGrid, GridShape{4, 11, 100}, GridShape{7, 7, 20}}) {
      for (int number = 0; number < kViews; ++number) {
        const GridPair corners = rig.grid_corners(shape, number);
        for (const Vector2d& pixel : corners.left) EXPECT_TRUE(in_picture(pixel, rig.rig(), 3));
        for (const Vector2d& pixel : corners.right) EXPECT_TRUE(in_picture(pixel, rig.rig(), 3));
      }
    }
  }
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

TEST(Truth, HasAsManyLevelsADisparityAsAPictureAllows) {
  const Truth truth = truth_of({0.2F, 1.5F, std::nanf(""), 64, 84.9F, -1}, 3, 80);
  EXPECT_EQ(truth.scale, 3);
  EXPECT_EQ(truth.grey.width, 3);
  EXPECT_EQ(truth.grey.height, 2);
  EXPECT_EQ(truth.grey.pixels, (std::vector<std::uint8_t>{1, 5, 0, 192, 255, 0}));
  EXPECT_EQ(truth_of({86}, 1, 80).grey.pixels.front(), 0);
}

}  // namespace
}  // namespace stereotlm::media
