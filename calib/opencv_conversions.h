#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <stdexcept>

#include "models/kernels/gray_image.h"

// Conversions to and from cv::Mat. OpenCV's own header for Eigen is not used, because it depends on the order
// of includes.
namespace stereotlm::calib {

template <typename Derived>
cv::Mat to_mat(const Eigen::MatrixBase<Derived>& matrix) {
  cv::Mat result(static_cast<int>(matrix.rows()), static_cast<int>(matrix.cols()), CV_64F);
  for (int row = 0; row < result.rows; ++row) {
    for (int column = 0; column < result.cols; ++column) result.at<double>(row, column) = matrix(row, column);
  }
  return result;
}

// The coefficients of a lens as a matrix of 1 x 5.
inline cv::Mat to_mat(const std::array<double, 5>& coefficients) {
  return cv::Mat(1, 5, CV_64F, const_cast<double*>(coefficients.data())).clone();
}

// Throws std::invalid_argument unless the matrix has the size of `Matrix` and holds doubles.
template <typename Matrix>
Matrix to_eigen(const cv::Mat& matrix) {
  Matrix result;
  if (matrix.type() != CV_64FC1 || matrix.rows != result.rows() || matrix.cols != result.cols()) {
    throw std::invalid_argument("matrix = " + std::to_string(matrix.rows) + "x" +
                                std::to_string(matrix.cols) + ": must be " + std::to_string(result.rows()) +
                                "x" + std::to_string(result.cols()) + " doubles");
  }
  for (int row = 0; row < matrix.rows; ++row) {
    for (int column = 0; column < matrix.cols; ++column) result(row, column) = matrix.at<double>(row, column);
  }
  return result;
}

// The image as a cv::Mat that shares its pixels. The image must outlive the result. The result must not be
// written to: OpenCV has no read-only view.
inline cv::Mat view(const kernels::GrayImage& image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};
}

}  // namespace stereotlm::calib
