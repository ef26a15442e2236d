#include "sw/media/encode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "models/kernels/words.h"

namespace stereotlm::media {
namespace {

kernels::GrayImage ramp(int width, int height) {
  kernels::GrayImage image(width, height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(i % 256);
  return image;
}

TEST(EncodePngGray, ReadsBackAsEightBitGrey) {
  const kernels::GrayImage image = ramp(33, 20);
  const cv::Mat read = cv::imdecode(encode_png_gray(image), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_8UC1);
  ASSERT_EQ(read.size(), cv::Size(33, 20));
  EXPECT_EQ(std::memcmp(read.data, image.pixels.data(), image.pixels.size()), 0);
  EXPECT_EQ(encode_png_gray(image), encode_png_gray(image));
}

TEST(EncodeDisparityColorPng, SpreadsTurboOverTheDisparities) {
  kernels::GrayImage disparity(4, 1);
  disparity.pixels = {0, 40, 80, kernels::kInvalidDisparity};
  const cv::Mat read = cv::imdecode(encode_disparity_color_png(disparity, 81), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_8UC3);
  const cv::Mat levels = (cv::Mat_<std::uint8_t>(1, 3) << 0, 128, 255);
  cv::Mat turbo;
  cv::applyColorMap(levels, turbo, cv::COLORMAP_TURBO);
  for (int x = 0; x < 3; ++x) EXPECT_EQ(read.at<cv::Vec3b>(x), turbo.at<cv::Vec3b>(x)) << x;
  EXPECT_EQ(read.at<cv::Vec3b>(3), cv::Vec3b(0, 0, 0));
}

TEST(EncodeDisparityColorPng, TakesDisparitiesBelowTheirNumberOnly) {
  EXPECT_NO_THROW(encode_disparity_color_png(kernels::GrayImage(1, 1, 0), 1));
  EXPECT_NO_THROW(encode_disparity_color_png(kernels::GrayImage(1, 1, 253), 254));
  EXPECT_THROW(encode_disparity_color_png(kernels::GrayImage(1, 1, 1), 1), std::invalid_argument);
  EXPECT_THROW(encode_disparity_color_png(kernels::GrayImage(1, 1, 254), 254), std::invalid_argument);
  EXPECT_THROW(encode_disparity_color_png(kernels::GrayImage(1, 1, 0), 0), std::invalid_argument);
  EXPECT_THROW(encode_disparity_color_png(kernels::GrayImage(1, 1, 0), 255), std::invalid_argument);
}

TEST(EncodePfm, HasRowsBottomToTopAndInfinityForInvalid) {
  kernels::GrayImage disparity(2, 2);
  disparity.pixels = {0, 1, kernels::kInvalidDisparity, 79};
  const auto bytes = encode_pfm(disparity);
  const std::string expected(
      "Pf\n2 2\n-1.0\n\x00\x00\x80\x7F\x00\x00\x9E\x42\x00\x00\x00\x00\x00\x00\x80\x3F", 28);
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), expected);
}

TEST(Encoders, RefuseAnImageThatIsEmptyOrNotWhole) {
  kernels::GrayImage broken(2, 2);
  broken.pixels.pop_back();
  for (const kernels::GrayImage& image : {kernels::GrayImage(), broken}) {
    EXPECT_THROW(encode_png_gray(image), std::invalid_argument);
    EXPECT_THROW(encode_disparity_color_png(image, 80), std::invalid_argument);
    EXPECT_THROW(encode_pfm(image), std::invalid_argument);
  }
}

TEST(NearestDisparity, RoundsTheTruthAndLeavesOutWhatCannotBeSearched) {
  kernels::GrayImage grey(6, 1);
  grey.pixels = {0, 1, 2, 13, 14, 255};  // scale 4: unknown, 0.25, 0.5, 3.25, 3.5, 63.75
  EXPECT_EQ(
      nearest_disparity({grey, 4}, 4).pixels,
      (std::vector<std::uint8_t>{255, 0, 1, 3, kernels::kInvalidDisparity, kernels::kInvalidDisparity}));
  EXPECT_EQ(nearest_disparity({grey, 4}, 5).pixels[4], 4);
}

}  // namespace
}  // namespace stereotlm::media
