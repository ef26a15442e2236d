#include "calib/camera_model.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <stdexcept>
#include <vector>

#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

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
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), to_mat(camera().matrix), to_mat(camera().distortion),
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
  EXPECT_NO_THROW(folded.direction({341 + 533 * 0.54, 234}));
  EXPECT_THROW(folded.direction({341 + 533 * 0.55, 234}), std::domain_error);
}

}  // namespace
}  // namespace stereotlm::calib
