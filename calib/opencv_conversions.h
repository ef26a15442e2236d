#pragma once

#include <Eigen/Core>
#include <opencv2/core/eigen.hpp>  // needs Eigen before it
#include <opencv2/core/mat.hpp>

#include "calib/rig.h"
#include "models/kernels/gray_image.h"

// Conversions to and from cv::Mat.
namespace stereotlm::calib {

template <typename Matrix>
cv::Mat to_mat(const Matrix& matrix) {
  cv::Mat result;
  cv::eigen2cv(matrix, result);
  return result;
}

// The coefficients of a camera's lens as a matrix of 1 x 4, 5, 8 or 12.
inline cv::Mat coefficients_of(const CameraModel& camera) {
  return cv::Mat(1, static_cast<int>(camera.coefficients()), CV_64F,
                 const_cast<double*>(camera.distortion.data()))
      .clone();
}

// `matrix` has the size of `Matrix` and holds doubles.
template <typename Matrix>
Matrix to_eigen(const cv::Mat& matrix) {
  Matrix result;
  cv::cv2eigen(matrix, result);
  return result;
}

// The image as a cv::Mat that shares its pixels. The image must outlive the result. The result must not be
// written to: OpenCV has no read-only view.
inline cv::Mat view(const kernels::GrayImage& image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};
}

}  // namespace stereotlm::calib
