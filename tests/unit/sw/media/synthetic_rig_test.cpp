#include "sw/media/synthetic_rig.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <vector>

// tests/unit/calib/calibrate_test.cpp recovers the rig and the disparities from the pictures.
namespace stereotlm::media {
namespace {

using calib::GridShape;
using calib::Rectification;
using calib::Rig;
using calib::SourcePixels;
using Eigen::Vector3d;

constexpr GridShape kGrid = {9, 6, 25};

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

// The only row of one camera's picture shows nothing of the other's.
TEST(SyntheticRig, RefusesAGridThatFindsNoPlace) {
  const SyntheticRig rig(2, 2048, 1);
  EXPECT_THROW(rig.grid_view(kGrid, 0), std::domain_error);
  EXPECT_THROW(rig.grid_corners(kGrid, 0), std::domain_error);
}

TEST(SyntheticRig, HasNoMatchForHiddenPoints) {
  const SyntheticRig rig(3, 160, 120);
  int hidden = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const Eigen::Vector2d right = calib::seen_by(rig.rig(), rig.point({x, y}).value()).right;
      const bool is_inside = right.x() > 0 && right.x() < 159 && right.y() > 0 && right.y() < 119;
      hidden += is_inside && !rig.match({x, y}) ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, 100);
  EXPECT_LT(hidden, 160 * 120 / 10);
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
  const GreyTruth truth = truth_of({0.2F, 1.5F, std::nanf(""), 64, 84.9F, -1}, 3, 80);
  EXPECT_EQ(truth.scale, 3);
  EXPECT_EQ(truth.grey.width, 3);
  EXPECT_EQ(truth.grey.height, 2);
  EXPECT_EQ(truth.grey.pixels, (std::vector<std::uint8_t>{1, 5, 0, 192, 255, 0}));
  EXPECT_EQ(truth_of({86}, 1, 80).grey.pixels.front(), 0);
}

}  // namespace
}  // namespace stereotlm::media
