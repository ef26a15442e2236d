#include "sw/media/load.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "sw/media/media_errors.h"
#include "sw/media/picture_file.h"

namespace stereotlm::media {
namespace {

kernels::GrayImage to_gray_image(const cv::Mat& picture) {
  kernels::GrayImage image(picture.cols, picture.rows);
  picture.copyTo(cv::Mat(picture.rows, picture.cols, CV_8UC1, image.pixels.data()));
  return image;
}

}  // namespace

LoadedGray load_gray(const std::string& path) {
  const cv::Mat picture = read_picture(path);
  if (picture.channels() == 1) return {to_gray_image(picture), false};
  cv::Mat gray;
  cv::cvtColor(picture, gray, cv::COLOR_BGR2GRAY);
  return {to_gray_image(gray), true};
}

Truth load_truth(const std::string& path, double scale) {
  if (!std::isfinite(scale) || scale <= 0) {
    throw std::invalid_argument("truth scale = " + std::to_string(scale) + ": must be positive and finite");
  }
  const cv::Mat picture = read_picture(path);
  if (picture.channels() != 1) throw_media_error(path, "8-bit colour", "ground truth must be 8-bit grey");
  return {to_gray_image(picture), scale};
}

}  // namespace stereotlm::media
