#include "sw/media/panels.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace stereotlm::media {
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

TEST(SideBySide, ShowsGreyAndColouredPicturesUnchanged) {
  const cv::Mat canvas = drawn({{"left", kernels::GrayImage(100, 40, 77)},
                                {"disparity", kernels::GrayImage(60, 50, 255), 80},
                                {"truth", kernels::GrayImage(60, 50, 79), 80}});
  ASSERT_EQ(canvas.size(), cv::Size(8 + 100 + 8 + 60 + 8 + 60 + 8, 32 + 50 + 8));
  EXPECT_EQ(canvas.at<cv::Vec3b>(kTop, kLeft), cv::Vec3b(77, 77, 77));
  EXPECT_EQ(canvas.at<cv::Vec3b>(kTop + 39, kLeft + 99), cv::Vec3b(77, 77, 77));
  EXPECT_EQ(canvas.at<cv::Vec3b>(kTop + 40, kLeft + 99), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(canvas.at<cv::Vec3b>(kTop + 49, kLeft + 108), cv::Vec3b(0, 0, 0));
  const cv::Vec3b nearest = canvas.at<cv::Vec3b>(kTop, kLeft + 108 + 68);
  EXPECT_GT(nearest[2], nearest[0]) << "the largest disparity is red";
}

TEST(SideBySide, CaptionsEachPictureAboveItInItsWidth) {
  for (const std::string& caption : {std::string("left"), std::string(60, 'm')}) {
    const kernels::GrayImage picture(80, 10);
    const cv::Mat canvas = drawn({{caption, picture}, {"", picture}, {"x", picture}});
    EXPECT_TRUE(has_ink(canvas, {kLeft, 8, 80, 24}));
    EXPECT_FALSE(has_ink(canvas, {kLeft + 88, 8, 80, 24}));
    EXPECT_TRUE(has_ink(canvas, {kLeft + 176, 8, 80, 24}));
  }
}

TEST(SideBySide, RefusesWhatCannotBeShown) {
  EXPECT_THROW(encode_side_by_side_png({}), std::invalid_argument);
  EXPECT_THROW(encode_side_by_side_png({{"empty", kernels::GrayImage()}}), std::invalid_argument);
  EXPECT_THROW(encode_side_by_side_png({{"d", kernels::GrayImage(4, 4, 80), 80}}), std::invalid_argument);
  EXPECT_THROW(encode_side_by_side_png({{"d", kernels::GrayImage(4, 4), -1}}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::media
