#include "sw/media/encode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/png.h"
#include "models/kernels/words.h"

namespace stereotlm::media {
namespace {

kernels::GrayImage ramp(int width, int height) {
  kernels::GrayImage image(width, height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(i % 256);
  return image;
}

std::vector<std::uint8_t> png_of_opencv(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  return bytes;
}

TEST(EncodePng, GivesTheBytesOfOpenCV) {
  kernels::GrayImage image = ramp(33, 20);
  EXPECT_EQ(encode_png_gray(image), png_of_opencv(cv::Mat(20, 33, CV_8UC1, image.pixels.data())));
  std::vector<std::uint16_t> values(33 * 20);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::uint16_t>(i * 101);
  EXPECT_EQ(calib::encode_png(33, 20, calib::PngPixel::kGrey16, values.data()),
            png_of_opencv(cv::Mat(20, 33, CV_16UC1, values.data())));
  const auto colours = encode_disparity_color_png(kernels::GrayImage(33, 20, 7), 80);
  EXPECT_EQ(colours, png_of_opencv(cv::imdecode(colours, cv::IMREAD_UNCHANGED)));
}

TEST(EncodeDisparityColorPng, SpreadsTurboOverTheDisparities) {
  kernels::GrayImage levels(254, 1);
  cv::Mat turbo(1, 254, CV_8UC1);
  for (int d = 0; d < 254; ++d) {
    levels.at(d, 0) = static_cast<std::uint8_t>(d);
    turbo.at<std::uint8_t>(d) = static_cast<std::uint8_t>(std::lround(255.0 * d / 253));
  }
  cv::applyColorMap(turbo, turbo, cv::COLORMAP_TURBO);
  const cv::Mat read = cv::imdecode(encode_disparity_color_png(levels, 254), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_8UC3);
  for (int x = 0; x < 254; ++x) EXPECT_EQ(read.at<cv::Vec3b>(x), turbo.at<cv::Vec3b>(x)) << x;
  const kernels::GrayImage invalid(1, 1, kernels::kInvalidDisparity);
  EXPECT_EQ(cv::imdecode(encode_disparity_color_png(invalid, 80), cv::IMREAD_UNCHANGED).at<cv::Vec3b>(0),
            cv::Vec3b(0, 0, 0));
}

}  // namespace
}  // namespace stereotlm::media
