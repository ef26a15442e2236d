#include "calib/synthetic_rig.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "calib/grid_pose.h"
#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr GridShape kShape = {9, 6, 25};
constexpr int kViews = 12;

bool in_picture(const Vector2d& pixel, const Rig& rig, double margin = 0) {
  return pixel.x() >= margin && pixel.x() <= rig.width - 1 - margin && pixel.y() >= margin &&
         pixel.y() <= rig.height - 1 - margin;
}

// Bilinear; the position is in the picture.
double level_at(const kernels::GrayImage& image, const Vector2d& position) {
  const int x = std::min(static_cast<int>(position.x()), image.width - 2);
  const int y = std::min(static_cast<int>(position.y()), image.height - 2);
  const double right = position.x() - x;
  const double down = position.y() - y;
  return (1 - down) * ((1 - right) * image.at(x, y) + right * image.at(x + 1, y)) +
         down * ((1 - right) * image.at(x, y + 1) + right * image.at(x + 1, y + 1));
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
  EXPECT_EQ(a.rig().left.matrix, b.rig().left.matrix);
  EXPECT_EQ(a.scene().left, b.scene().left);
  EXPECT_EQ(a.scene().right, b.scene().right);
  EXPECT_EQ(a.grid_view(kShape, 3).left, b.grid_view(kShape, 3).left);
  EXPECT_EQ(a.grid_view(kShape, 3).right, b.grid_view(kShape, 3).right);
  const SyntheticRig other(6, 64, 48);
  EXPECT_NE(a.rig().left.matrix, other.rig().left.matrix);
  EXPECT_NE(a.rig().right.distortion, other.rig().right.distortion);
  EXPECT_NE(a.rig().rotation, other.rig().rotation);
  EXPECT_NE(a.scene().left, other.scene().left);
  EXPECT_NE(a.grid_corners(kShape, 0).left, other.grid_corners(kShape, 0).left);
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

TEST(SyntheticRig, RefusesPictureSizesOutsideTheRangeOfABoard) {
  for (const int width : {-4, 0, 3, 6, 2052}) EXPECT_THROW(SyntheticRig(1, width, 48), std::invalid_argument);
  for (const int height : {-1, 0, 2049}) EXPECT_THROW(SyntheticRig(1, 64, height), std::invalid_argument);
  EXPECT_NO_THROW(SyntheticRig(1, 2048, 1));
  EXPECT_NO_THROW(SyntheticRig(1, 4, 2048));
}

TEST(SyntheticRig, SeesASceneInAnyShapeOfPicture) {
  for (const auto& [width, height] : {std::pair{4, 1}, {4, 300}, {300, 1}, {64, 64}}) {
    const SyntheticRig rig(2, width, height);
    EXPECT_EQ(rig.scene().left.width, width);
    EXPECT_EQ(rig.scene().right.height, height);
    EXPECT_TRUE(rig.point({0, height - 1}));
  }
}

TEST(SyntheticRig, RefusesGridsOutsideTheirRange) {
  const SyntheticRig rig(1, 64, 48);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const GridShape& shape : {GridShape{0, 6, 25},
                                 {1001, 6, 25},
                                 {9, 0, 25},
                                 {9, 1001, 25},
                                 {9, 6, 0},
                                 {9, 6, -1},
                                 {9, 6, nan},
                                 {9, 6, infinite}}) {
    EXPECT_THROW(rig.grid_view(shape, 0), std::invalid_argument);
    EXPECT_THROW(rig.grid_corners(shape, 0), std::invalid_argument);
  }
  EXPECT_THROW(rig.grid_view(kShape, -1), std::invalid_argument);
  EXPECT_NO_THROW(rig.grid_view({1, 1, 0.5}, 0));
}

// The only row of one camera's picture shows nothing of the other's.
TEST(SyntheticRig, RefusesAGridThatFindsNoPlace) {
  const SyntheticRig rig(2, 2048, 1);
  EXPECT_THROW(rig.grid_view(kShape, 0), std::domain_error);
  EXPECT_THROW(rig.grid_corners(kShape, 0), std::domain_error);
}

TEST(SyntheticRig, ShowsEveryCornerToBothCameras) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const SyntheticRig rig(seed, 320, 240);
    for (const GridShape& shape : {kShape, GridShape{4, 11, 100}, GridShape{7, 7, 20}}) {
      for (int number = 0; number < kViews; ++number) {
        const SyntheticRig::CornerPair corners = rig.grid_corners(shape, number);
        constexpr double kMargin = 3;
        for (const Vector2d& pixel : corners.left) EXPECT_TRUE(in_picture(pixel, rig.rig(), kMargin));
        for (const Vector2d& pixel : corners.right) EXPECT_TRUE(in_picture(pixel, rig.rig(), kMargin));
      }
    }
  }
}

TEST(SyntheticRig, SpreadsThePosesOfTheGrid) {
  const SyntheticRig rig(7, 320, 240);
  Eigen::AlignedBox2d covered;
  double nearest = 1e9, farthest = 0, least_tilt = 90, most_tilt = 0;
  const std::vector<bool> all(static_cast<std::size_t>(kShape.corners()), true);
  for (int number = 0; number < kViews; ++number) {
    const auto corners = rig.grid_corners(kShape, number);
    for (const Vector2d& pixel : corners.left) covered.extend(pixel);
    const Eigen::Isometry3d pose = grid_pose(rig.rig(), kShape, {corners.left, corners.right}, all);
    const Vector3d middle = pose * Vector3d(100, 62.5, 0);
    const double distance = middle.norm();
    const double tilt = std::acos(pose.linear().col(2).dot(middle) / distance) * 180 / CV_PI;
    nearest = std::min(nearest, distance);
    farthest = std::max(farthest, distance);
    least_tilt = std::min(least_tilt, tilt);
    most_tilt = std::max(most_tilt, tilt);
  }
  EXPECT_GT(farthest, 1.25 * nearest);
  EXPECT_GT(least_tilt, 9.9);
  EXPECT_LT(least_tilt, 18);
  EXPECT_GT(most_tilt, 27);
  EXPECT_LT(most_tilt, 35.1);
  EXPECT_GT(covered.sizes().x(), 0.65 * 320);  // the left camera sees some of the rest alone
  EXPECT_GT(covered.sizes().y(), 0.65 * 240);
}

TEST(SyntheticRig, ShowsGridsWhereTheirCornersAre) {
  const SyntheticRig rig(7, 240, 180);
  constexpr GridShape kFewer = {7, 5, 30};
  double sum = 0;
  double worst = 0;
  for (int number = 0; number < kViews; ++number) {
    const SyntheticRig::Pair pair = rig.grid_view(kFewer, number);
    const SyntheticRig::CornerPair exact = rig.grid_corners(kFewer, number);
    for (const bool left : {true, false}) {
      const cv::Mat picture = view(left ? pair.left : pair.right);
      const Corners& expected = left ? exact.left : exact.right;
      std::vector<cv::Point2f> found;
      ASSERT_TRUE(cv::findChessboardCorners(picture, {kFewer.columns, kFewer.rows}, found)) << number;
      cv::cornerSubPix(picture, found, {4, 4}, {-1, -1},
                       {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 50, 1e-4});
      if (found.front().x > found.back().x) std::reverse(found.begin(), found.end());
      for (std::size_t i = 0; i < found.size(); ++i) {
        const double error = std::hypot(found[i].x - expected[i].x(), found[i].y - expected[i].y());
        sum += error;
        worst = std::max(worst, error);
      }
    }
  }
  EXPECT_LT(sum / (2 * kViews * kFewer.corners()), 0.07);
  EXPECT_LT(worst, 0.25);
}

TEST(SyntheticRig, KnowsThePointBehindAPixelAndItsMatch) {
  const SyntheticRig rig(3, 160, 120);
  int matches = 0;
  for (int y = 0; y < 120; y += 7) {
    for (int x = 0; x < 160; x += 7) {
      const auto point = rig.point({x, y});
      ASSERT_TRUE(point);
      EXPECT_GT(point->z(), 500);
      const SeenPoint seen = seen_by(rig.rig(), *point);
      EXPECT_LT((seen.left - Vector2d(x, y)).norm(), 1e-6);
      const auto match = rig.match({x, y});
      if (!match) continue;
      ++matches;
      EXPECT_LT((seen.right - *match).norm(), 1e-6);
    }
  }
  EXPECT_GT(matches, 300);
}

TEST(SyntheticRig, ShowsTheSameLevelAtAMatch) {
  const SyntheticRig rig(3, 160, 120);
  const SyntheticRig::Pair pair = rig.scene();
  double there = 0, above = 0, left_of_it = 0;
  int matches = 0;
  for (int y = 2; y < 118; y += 2) {
    for (int x = 2; x < 158; x += 2) {
      const auto match = rig.match({x, y});
      if (!match || !in_picture(*match, rig.rig(), 3)) continue;
      ++matches;
      const double level = pair.left.at(x, y);
      there += std::abs(level - level_at(pair.right, *match));
      above += std::abs(level - level_at(pair.right, *match - Vector2d(0, 2)));
      left_of_it += std::abs(level - level_at(pair.right, *match - Vector2d(2, 0)));
    }
  }
  ASSERT_GT(matches, 3000);
  EXPECT_LT(there / matches, 8);
  EXPECT_GT(above / matches, 15);
  EXPECT_GT(left_of_it / matches, 15);
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

TEST(SyntheticRig, HasNoDisparityOutsideTheView) {
  const SyntheticRig synthetic(4, 80, 60);
  for (const float d : synthetic.disparity(synthetic.rig(), rectify(synthetic.rig()), 120)) {
    EXPECT_TRUE(std::isnan(d));
  }
}

TEST(SyntheticRig, RefusesACalibrationWithAnotherPictureSize) {
  const SyntheticRig synthetic(4, 80, 60);
  const Rectification ideal = rectify(synthetic.rig());
  Rig other = synthetic.rig();
  other.width = 84;
  EXPECT_THROW(synthetic.disparity(other, ideal, 0), std::invalid_argument);
  other = synthetic.rig();
  other.height = 61;
  EXPECT_THROW(synthetic.disparity(other, ideal, 0), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::calib
