#include "sw/media/encode.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "models/kernels/stereo.h"
#include "models/kernels/words.h"
#include "sw/media/color_map.h"

namespace stereotlm::media {

cv::Mat view(const kernels::GrayImage& image) {
  const auto pixels = static_cast<long long>(image.width) * image.height;
  if (image.width <= 0 || image.height <= 0 || pixels != static_cast<long long>(image.pixels.size())) {
    throw std::invalid_argument(fmt::format("image = {}x{} with {} pixels: must be whole and not empty",
                                            image.width, image.height, image.pixels.size()));
  }
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};
}

std::vector<std::uint8_t> encode_png(const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", picture, bytes))
    throw std::runtime_error("a picture could not be encoded as PNG");
  return bytes;
}

void check_levels(const kernels::GrayImage& disparity, int disparities) {
  if (!kernels::kDisparitiesRule.allows(disparities)) {
    throw std::invalid_argument(kernels::kDisparitiesRule.problem("disparities", disparities));
  }
  view(disparity);  // throws for an empty image
  for (int y = 0; y < disparity.height; ++y) {
    for (int x = 0; x < disparity.width; ++x) {
      const int d = disparity.at(x, y);
      if (d != kernels::kInvalidDisparity && d >= disparities) {
        throw std::invalid_argument(fmt::format("disparity ({}, {}) = {}: must be {} or less than {}", x, y,
                                                d, kernels::kInvalidDisparity, disparities));
      }
    }
  }
}

std::vector<std::uint8_t> encode_png_gray(const kernels::GrayImage& image) { return encode_png(view(image)); }

std::vector<std::uint8_t> encode_png_16(int width, int height, const std::vector<std::uint16_t>& values) {
  if (width <= 0 || height <= 0 ||
      values.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    throw std::invalid_argument(fmt::format("image = {}x{} with {} values: must be whole and not empty",
                                            width, height, values.size()));
  }
  return encode_png({height, width, CV_16UC1, const_cast<std::uint16_t*>(values.data())});
}

std::vector<std::uint8_t> encode_disparity_color_png(const kernels::GrayImage& disparity, int disparities) {
  check_levels(disparity, disparities);
  cv::Mat levels(1, disparities, CV_8UC1);
  for (int d = 0; d < disparities; ++d) {
    levels.at<std::uint8_t>(d) =
        static_cast<std::uint8_t>(disparities == 1 ? 0 : std::lround(255.0 * d / (disparities - 1)));
  }
  cv::Mat colors;
  cv::applyColorMap(levels, colors, cv::COLORMAP_TURBO);
  cv::Mat result = cv::Mat::zeros(view(disparity).size(), CV_8UC3);
  for (int y = 0; y < disparity.height; ++y) {
    for (int x = 0; x < disparity.width; ++x) {
      const int d = disparity.at(x, y);
      if (d != kernels::kInvalidDisparity) result.at<cv::Vec3b>(y, x) = colors.at<cv::Vec3b>(d);
    }
  }
  return encode_png(result);
}

std::vector<std::uint8_t> encode_pfm(const kernels::GrayImage& disparity) {
  view(disparity);  // throws for an empty image
  const std::string header = fmt::format("Pf\n{} {}\n-1.0\n", disparity.width, disparity.height);
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  bytes.reserve(bytes.size() + 4 * disparity.pixels.size());
  for (int y = disparity.height - 1; y >= 0; --y) {
    for (int x = 0; x < disparity.width; ++x) {
      const int d = disparity.at(x, y);
      const float value =
          d == kernels::kInvalidDisparity ? std::numeric_limits<float>::infinity() : static_cast<float>(d);
      std::uint32_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      for (unsigned shift = 0; shift < 32; shift += 8)
        bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
  }
  return bytes;
}

kernels::GrayImage nearest_disparity(const Truth& truth, int disparities) {
  kernels::GrayImage result(truth.grey.width, truth.grey.height, kernels::kInvalidDisparity);
  for (std::size_t i = 0; i < truth.grey.pixels.size(); ++i) {
    const double nearest = std::floor(truth.grey.pixels[i] / truth.scale + 0.5);
    if (truth.grey.pixels[i] != 0 && nearest < disparities)
      result.pixels[i] = static_cast<std::uint8_t>(nearest);
  }
  return result;
}

}  // namespace stereotlm::media
