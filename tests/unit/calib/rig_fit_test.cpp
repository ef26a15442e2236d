#include "calib/rig_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <random>
#include <stdexcept>
#include <vector>

#include "calib/opencv_conversions.h"
#include "calib/rig.h"
#include "sw/media/synthetic_rig.h"

namespace stereotlm::calib {
namespace {

class RigFitTest : public testing::Test {
 protected:
  static constexpr GridShape kShape = {9, 6, 25};
  static constexpr int kPairs = 12;

  RigFitTest() {
    for (int number = 0; number < kPairs; ++number) {
      const auto corners = known_.grid_corners(kShape, number);
      pairs_.push_back({corners.left, corners.right});
    }
  }

  RigFit fit() const { return fit_rig(kShape, 640, 480, pairs_); }

  void add_noise(double deviation_px) {
    std::mt19937 generator(7);
    std::normal_distribution<double> noise(0, deviation_px);
    for (GridPair& pair : pairs_) {
      for (Corners* corners : {&pair.left, &pair.right}) {
        for (Eigen::Vector2d& corner : *corners)
          corner += Eigen::Vector2d(noise(generator), noise(generator));
      }
    }
  }

  void expect_known(const Rig& rig, double pixels, double direction, double millimetres) const {
    const Rig& known = known_.rig();
    EXPECT_LT((rig.left.matrix - known.left.matrix).cwiseAbs().maxCoeff(), pixels);
    EXPECT_LT((rig.right.matrix - known.right.matrix).cwiseAbs().maxCoeff(), pixels);
    EXPECT_LT((rig.rotation - known.rotation).cwiseAbs().maxCoeff(), direction);
    EXPECT_LT((rig.translation - known.translation).cwiseAbs().maxCoeff(), millimetres);
    // What the lens does at the border of the picture, where few corners are.
    for (const Eigen::Vector2d& corner : {Eigen::Vector2d(60, 45), Eigen::Vector2d(580, 435)}) {
      EXPECT_LT((rig.left.direction(corner) - known.left.direction(corner)).norm(), 5 * direction);
    }
  }

  media::SyntheticRig known_{5, 640, 480};
  std::vector<GridPair> pairs_;
};

TEST_F(RigFitTest, RecoversARigFromCornersWithNoise) {
  add_noise(0.1);
  const RigFit found = fit();
  expect_known(found.rig, 2, 2e-3, 0.5);
  EXPECT_NEAR(found.stereo_rms_px, 0.1 * std::sqrt(2.0), 0.01);
  EXPECT_NEAR(found.left_rms_px, 0.1 * std::sqrt(2.0), 0.02);
  EXPECT_NEAR(found.right_rms_px, 0.1 * std::sqrt(2.0), 0.02);
  EXPECT_TRUE(found.left_out.empty());
}

TEST_F(RigFitTest, LeavesOutCornersThatDoNotFit) {
  add_noise(0.1);
  const RigFit without = fit();
  pairs_[2].left[7] += Eigen::Vector2d(3, -2);
  pairs_[9].right[50] += Eigen::Vector2d(-40, 0);
  const RigFit found = fit();
  ASSERT_EQ(found.left_out.size(), 2U);
  EXPECT_EQ(found.left_out[0].pair, 2U);
  EXPECT_EQ(found.left_out[0].corner, 7U);
  EXPECT_NEAR(found.left_out[0].misfit_px, std::hypot(3, 2), 0.5);
  EXPECT_EQ(found.left_out[1].pair, 9U);
  EXPECT_EQ(found.left_out[1].corner, 50U);
  EXPECT_NEAR(found.left_out[1].misfit_px, 40, 0.5);
  EXPECT_FALSE(found.used[2][7]);
  EXPECT_TRUE(found.used[2][8]);
  EXPECT_NEAR(found.stereo_rms_px, without.stereo_rms_px, 0.005);
}

TEST_F(RigFitTest, LeavesOutAPairWhoseGridMovedBetweenThePictures) {
  add_noise(0.1);
  const auto other = known_.grid_corners(kShape, kPairs);
  pairs_[4].right = other.right;
  const RigFit found = fit();
  EXPECT_EQ(found.left_out.size(), static_cast<std::size_t>(kShape.corners()));
  EXPECT_THAT(found.used[4], testing::Each(false));
  expect_known(found.rig, 2, 2e-3, 0.5);
}

TEST_F(RigFitTest, RefusesFewerThanThreePairs) {
  pairs_.resize(2);
  EXPECT_THROW(fit(), std::invalid_argument);
}

CameraModel camera() {
  CameraModel camera;
  camera.matrix << 533, 0, 341, 0, 531, 234, 0, 0, 1;
  camera.distortion = {-0.28, 0.07, 0.0012, -0.0007, 0.01};
  return camera;
}

TEST(CameraModel, SeesPointsWhereOpenCVDoes) {
  std::vector<cv::Point3d> points;
  for (double y = -0.4; y < 0.45; y += 0.1) {
    for (double x = -0.6; x < 0.65; x += 0.1) points.emplace_back(700 * x, 700 * y, 700);
  }
  std::vector<cv::Point2d> expected;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), to_mat(camera().matrix), coefficients_of(camera()),
                    expected);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d found = camera().pixel({points[i].x / 700, points[i].y / 700});
    EXPECT_NEAR(found.x(), expected[i].x, 1e-9);
    EXPECT_NEAR(found.y(), expected[i].y, 1e-9);
  }
}

TEST(CameraModel, FindsTheDirectionOfEveryPixel) {
  for (double y = 0; y < 480; y += 39.5) {
    for (double x = 0; x < 640; x += 39.5) {
      const Eigen::Vector2d found = camera().pixel(camera().direction({x, y}));
      EXPECT_NEAR(found.x(), x, 1e-9);
      EXPECT_NEAR(found.y(), y, 1e-9);
    }
  }
}

TEST(CameraModel, HasNoDirectionWhereTheLensFoldsThePicture) {
  CameraModel folded = camera();
  folded.distortion = {-0.5, 0, 0, 0, 0};  // the farthest it sees: direction 0.8165, bent to 0.5443
  EXPECT_NEAR(folded.widest(), 0.8165, 1e-3);
  EXPECT_EQ(CameraModel().widest(), 10);
  folded.distortion = {0, -0.5, 0, 0, 0};
  EXPECT_NEAR(folded.widest(), std::pow(1 / 2.5, 1.0 / 4), 1e-3);
  folded.distortion = {0, 0, 0, 0, -0.5};
  EXPECT_NEAR(folded.widest(), std::pow(1 / 3.5, 1.0 / 6), 1e-3);
  folded.distortion = {-0.5, 0, 0, 0, 0};
  EXPECT_NO_THROW(folded.direction({341 + 533 * 0.54, 234}));
  EXPECT_THROW(folded.direction({341 + 533 * 0.55, 234}), std::domain_error);
}

}  // namespace
}  // namespace stereotlm::calib
