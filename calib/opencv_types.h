#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/eigen.hpp>
#include <opencv2/core/mat.hpp>

#include "models/kernels/gray_image.h"

// For the files of this folder that use OpenCV.
namespace stereotlm::calib {

template <typename Derived>
cv::Mat to_mat(const Eigen::MatrixBase<Derived>& matrix) {
  cv::Mat result;
  cv::eigen2cv(matrix.eval(), result);
  return result;
}

// 1 x 5
inline cv::Mat to_mat(const std::array<double, 5>& coefficients) {
  return cv::Mat(1, 5, CV_64F, const_cast<double*>(coefficients.data())).clone();
}

// The same pixels, not copied: the image must outlive the result, which must not be written to.
inline cv::Mat view(const kernels::GrayImage& image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};
}

}  // namespace stereotlm::calib
