#include "calib/depth.h"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <vector>

namespace stereotlm::calib {
namespace {

// Focal length 500 px, centre (4, 3), baseline 80 mm: depth = 40,000 / true disparity.
DepthGeometry geometry(int disparity_offset) {
  Eigen::Matrix4d q = Eigen::Matrix4d::Zero();
  q << 1, 0, 0, -4,  //
      0, 1, 0, -3,   //
      0, 0, 0, 500,  //
      0, 0, 1 / 80.0, 0;
  return {q, disparity_offset};
}

TEST(DepthGeometry, AddsTheOffsetToColumnAndDisparityBeforeQ) {
  const auto point = geometry(10).point(44, 53, 30);  // column 54, true disparity 40: 1 m away
  ASSERT_TRUE(point);
  EXPECT_DOUBLE_EQ(point->z(), 1000);
  EXPECT_DOUBLE_EQ(point->x(), (54 - 4) * 1000 / 500.0);
  EXPECT_DOUBLE_EQ(point->y(), (53 - 3) * 1000 / 500.0);
}

TEST(DepthGeometry, HasNoPointAtInfinityOrBehindTheCamera) {
  EXPECT_FALSE(geometry(0).point(4, 3, 0));
  EXPECT_FALSE(geometry(-5).point(4, 3, 5));
  EXPECT_FALSE(geometry(-5).point(4, 3, 4));
  EXPECT_TRUE(geometry(-5).point(4, 3, 6));
}

TEST(DepthInTheMiddle, IsThatOfABoardsDisparityOrInfinite) {
  Calibration calibration;
  calibration.rig.width = 8;
  calibration.rig.height = 6;
  calibration.rectification.q = geometry(0).q;
  calibration.disparity_offset = 10;
  EXPECT_DOUBLE_EQ(depth_in_the_middle(calibration, 30).value(), 1000);
  EXPECT_FALSE(depth_in_the_middle(calibration, -10));
}

TEST(DepthMillimetres, IsZeroAbove65535) {
  DepthGeometry far = geometry(0);
  far.q(2, 3) = 65535.4 / 80;
  const kernels::GrayImage disparity(1, 1, 1);
  EXPECT_EQ(depth_millimetres(far, disparity).front(), 65535);
  far.q(2, 3) = 65535.6 / 80;
  EXPECT_EQ(depth_millimetres(far, disparity).front(), 0);
}

float float_at(const std::string& bytes, std::size_t at) {
  float value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(PointCloudPly, HoldsPointsWithADisparityAndTheirGreys) {
  kernels::GrayImage disparity(3, 2, 255);
  kernels::GrayImage grey(3, 2, 7);
  disparity.at(2, 0) = 40;
  disparity.at(0, 1) = 0;  // no point
  disparity.at(1, 1) = 20;
  grey.at(1, 1) = 200;
  const std::string file = point_cloud_ply(geometry(0), disparity, grey);
  const std::string end = "end_header\n";
  const std::size_t points = file.find(end) + end.size();
  EXPECT_EQ(file.rfind("ply\nformat binary_little_endian 1.0\n", 0), 0U);
  EXPECT_NE(file.find("element vertex 2\n"), std::string::npos);
  ASSERT_EQ(file.size(), points + 2 * 15);
  EXPECT_FLOAT_EQ(float_at(file, points), (2 - 4) * 1000 / 500.0F);
  EXPECT_FLOAT_EQ(float_at(file, points + 4), (0 - 3) * 1000 / 500.0F);
  EXPECT_FLOAT_EQ(float_at(file, points + 8), 1000);
  EXPECT_EQ(file.substr(points + 12, 3), "\7\7\7");
  EXPECT_FLOAT_EQ(float_at(file, points + 15 + 8), 2000);
  EXPECT_EQ(file.substr(points + 15 + 12, 3), "\xC8\xC8\xC8");
}

TEST(DepthRange, LeavesOutTheNearestAndTheFarthestHundredthOfTheKnownDepths) {
  std::vector<std::uint16_t> depths(50, 0);
  EXPECT_FALSE(depth_range(depths));
  for (int depth = 1000; depth < 1200; ++depth) depths.push_back(static_cast<std::uint16_t>(depth));
  const auto range = depth_range(depths);
  ASSERT_TRUE(range);
  EXPECT_EQ(range->near_mm, 1002);
  EXPECT_EQ(range->far_mm, 1197);
  const auto one = depth_range({0, 700});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->near_mm, 700);
  EXPECT_EQ(one->far_mm, 701);
}

TEST(PointCloudPly, RefusesAPictureOfAnotherSize) {
  EXPECT_THROW(point_cloud_ply(geometry(0), kernels::GrayImage(3, 2), kernels::GrayImage(2, 3)),
               std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::calib
