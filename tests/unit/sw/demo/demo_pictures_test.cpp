#include "sw/demo/demo_pictures.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace stereotlm::demo {
namespace {

// Where the parts of the picture lie: margins of 8 pixels, 24 pixels of caption.
constexpr int kLeft = 8;
constexpr int kTop = 32;

cv::Mat drawn(const std::vector<Panel>& panels) {
  return cv::imdecode(encode_side_by_side_png(panels), cv::IMREAD_UNCHANGED);
}

bool has_ink(const cv::Mat& canvas, const cv::Rect& area) {
  return cv::countNonZero(canvas(area).clone().reshape(1) != 255) > 0;
}

Panel grey(const std::string& caption, const kernels::GrayImage& image) {
  return {caption, image, 0, "", "", ""};
}

Panel colored(const kernels::GrayImage& image, int levels) {
  return {"disparity", image, levels, "0", "79", "no answer"};
}

TEST(SideBySide, ShowsGreyAndColouredPictures) {
  const cv::Mat canvas =
      drawn({grey("left", kernels::GrayImage(100, 40, 77)), colored(kernels::GrayImage(60, 50, 255), 80),
             colored(kernels::GrayImage(60, 50, 79), 80), colored(kernels::GrayImage(60, 50, 0), 80)});
  ASSERT_EQ(canvas.size(), cv::Size(8 + 100 + 3 * (8 + 60) + 8, 32 + 50 + 28 + 8));
  EXPECT_EQ(canvas.at<cv::Vec3b>(kTop, kLeft), cv::Vec3b(77, 77, 77));
  EXPECT_EQ(canvas.at<cv::Vec3b>(kTop + 39, kLeft + 99), cv::Vec3b(77, 77, 77));
  EXPECT_EQ(canvas.at<cv::Vec3b>(kTop + 40, kLeft + 99), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(canvas.at<cv::Vec3b>(kTop + 49, kLeft + 108), cv::Vec3b(217, 217, 217));
  const cv::Vec3b most = canvas.at<cv::Vec3b>(kTop, kLeft + 108 + 68);
  EXPECT_EQ(most, cv::Vec3b(37, 231, 253)) << "the last colour of Viridis, yellow";
  const cv::Vec3b least = canvas.at<cv::Vec3b>(kTop, kLeft + 108 + 2 * 68);
  EXPECT_EQ(least, cv::Vec3b(84, 1, 68)) << "the first one, dark violet";
}

TEST(SideBySide, HasAScaleBelowColouredPicturesOnly) {
  const cv::Mat canvas =
      drawn({grey("left", kernels::GrayImage(320, 50, 77)), colored(kernels::GrayImage(320, 50, 3), 80)});
  EXPECT_FALSE(has_ink(canvas, {kLeft, kTop + 50, 320, 28}));
  EXPECT_TRUE(has_ink(canvas, {kLeft + 328, kTop + 50, 320, 28}));
}

TEST(SideBySide, CaptionsEachPictureAboveItInItsWidth) {
  for (const std::string& caption : {std::string("left"), std::string(60, 'm')}) {
    const kernels::GrayImage picture(80, 10);
    const cv::Mat canvas = drawn({grey(caption, picture), grey("", picture), grey("x", picture)});
    EXPECT_TRUE(has_ink(canvas, {kLeft, 8, 80, 24}));
    EXPECT_FALSE(has_ink(canvas, {kLeft + 88, 8, 80, 24}));
    EXPECT_TRUE(has_ink(canvas, {kLeft + 176, 8, 80, 24}));
  }
}

using kernels::GrayImage;

constexpr int kFullWidth = 2 * kWidth;
constexpr int kFullHeight = 2 * kHeight;

GrayImage full_size() { return GrayImage(kFullWidth, kFullHeight); }

TEST(MakeDemoPair, AveragesPicturesWithHalvesUp) {
  auto left = full_size();
  left.at(0, 0) = 1;
  left.at(1, 1) = 1;
  auto right = full_size();
  right.at(0, 1) = 1;
  const auto pair = make_demo_pair(left, right, full_size());
  EXPECT_EQ(pair.left.at(0, 0), 1);
  EXPECT_EQ(pair.right.at(0, 0), 0);
  const GrayImage white(kFullWidth, kFullHeight, 255);
  EXPECT_EQ(make_demo_pair(white, white, white).left.at(639, 479), 255);
}

TEST(MakeDemoPair, TakesTheTopLeftPixelOfTheTruthWithoutAveraging) {
  auto truth = full_size();
  truth.at(2, 4) = 200;
  truth.at(5, 4) = 100;
  const auto pair = make_demo_pair(full_size(), full_size(), truth);
  EXPECT_EQ(pair.truth.at(1, 2), 200);
  EXPECT_EQ(pair.truth.at(2, 2), 0);
}

TEST(MakeDemoPair, CropsLargerPicturesToTheSameMiddle) {
  GrayImage larger(kFullWidth + 9, kFullHeight + 21);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) larger.at(4 + column, 10 + row) = 77;
  }
  const auto pair = make_demo_pair(larger, larger, larger);
  for (const auto* image : {&pair.left, &pair.right, &pair.truth}) {
    EXPECT_EQ(image->width, 640);
    EXPECT_EQ(image->height, 480);
    EXPECT_EQ(image->at(0, 0), 77);
    EXPECT_EQ(image->at(1, 0), 0);
    EXPECT_EQ(image->at(0, 1), 0);
  }
}

TEST(MakeDemoPair, RefusesSmallerPicturesAndPicturesOfDifferentSizes) {
  const GrayImage narrow(kFullWidth - 1, kFullHeight);
  const GrayImage low(kFullWidth, kFullHeight - 1);
  const GrayImage wider(kFullWidth + 1, kFullHeight);
  EXPECT_THROW(make_demo_pair(narrow, narrow, narrow), std::invalid_argument);
  EXPECT_THROW(make_demo_pair(low, low, low), std::invalid_argument);
  EXPECT_THROW(make_demo_pair(full_size(), wider, full_size()), std::invalid_argument);
  EXPECT_THROW(make_demo_pair(full_size(), full_size(), wider), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::demo
