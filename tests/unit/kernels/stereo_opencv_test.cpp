#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "models/kernels/stereo.h"
#include "models/kernels/words.h"
#include "tests/support/random_board.h"
#include "tests/unit/kernels/reference_types.h"

// The kernels against OpenCV's functions for the same.
namespace stereotlm::kernels {
namespace {

GrayImage noise(int width, int height, test::SplitMix64& random) {
  GrayImage image(width, height);
  for (std::uint8_t& pixel : image.pixels) pixel = static_cast<std::uint8_t>(random.between(0, 255));
  return image;
}

cv::Mat mat_of(const GrayImage& image) {
  cv::Mat mat(image.height, image.width, CV_8U);
  std::copy(image.pixels.begin(), image.pixels.end(), mat.begin<std::uint8_t>());
  return mat;
}

// filter2D sums large kernels by a Fourier transform, whose rounding errors are far below one half here.
GrayImage filtered_by_opencv(const GrayImage& image, const FilterKernel& kernel) {
  const cv::Mat weights = cv::Mat(kernel.weights, true).reshape(1, kernel.size);
  cv::Mat weights_as_doubles;
  weights.convertTo(weights_as_doubles, CV_64F);
  cv::Mat sums;
  cv::Mat pixels;
  mat_of(image).convertTo(pixels, CV_64F);
  cv::filter2D(pixels, sums, CV_64F, weights_as_doubles, {-1, -1}, 0, cv::BORDER_REPLICATE);
  GrayImage filtered(image.width, image.height);
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const double level =
          128 + std::floor(std::ldexp(std::round(sums.at<double>(row, column)), -kernel.shift));
      filtered.at(column, row) = static_cast<std::uint8_t>(std::clamp(level, 0.0, 255.0));
    }
  }
  return filtered;
}

TEST(StereoAndOpenCv, HaveTheSameFilter) {
  test::SplitMix64 random(2);
  const GrayImage full_size = noise(320, 240, random);
  EXPECT_TRUE(test::filter_image(full_size, log7()) == filtered_by_opencv(full_size, log7()));
  int filters = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const test::RandomBoard board = test::make_random_board(seed);
    if (!board.filter) continue;
    ++filters;
    const GrayImage image = noise(board.width, board.height, random);
    const FilterKernel kernel = *test::filter_kernel(board.filter);
    ASSERT_TRUE(test::filter_image(image, kernel) == filtered_by_opencv(image, kernel)) << describe(board);
  }
  EXPECT_GT(filters, 200);
}

// Sums the absolute differences of each candidate with a box filter, and takes the smallest sum of those
// whose windows lie inside the image, of equal sums the first.
GrayImage matched_by_opencv(const GrayImage& left, const GrayImage& right, int window, int disparities) {
  const int width = left.width;
  const int height = left.height;
  const int r = (window - 1) / 2;
  const cv::Mat left_mat = mat_of(left);
  const cv::Mat right_mat = mat_of(right);
  GrayImage matched(width, height, kInvalidDisparity);
  cv::Mat best(height, width, CV_32S, cv::Scalar(std::numeric_limits<int>::max()));
  for (int d = 0; d < disparities && d + window <= width && window <= height; ++d) {
    cv::Mat difference;
    cv::Mat sums;
    cv::absdiff(left_mat.colRange(d, width), right_mat.colRange(0, width - d), difference);
    cv::boxFilter(difference, sums, CV_32S, {window, window}, {-1, -1}, false, cv::BORDER_REPLICATE);
    for (int row = r; row < height - r; ++row) {
      for (int column = d + r; column < width - r; ++column) {
        const int sum = sums.at<int>(row, column - d);
        int& smallest = best.at<int>(row, column);
        if (sum >= smallest) continue;
        smallest = sum;
        matched.at(column, row) = static_cast<std::uint8_t>(d);
      }
    }
  }
  return matched;
}

void expect_same_search(int width, int height, int window, int disparities, test::SplitMix64& random) {
  const GrayImage left = noise(width, height, random);
  const GrayImage right = noise(width, height, random);
  EXPECT_TRUE(test::match(left, right, window, disparities).left_based ==
              matched_by_opencv(left, right, window, disparities))
      << width << " x " << height << ", window " << window << ", disparities " << disparities;
}

TEST(StereoAndOpenCv, HaveTheSameLeftBasedSearch) {
  test::SplitMix64 random(3);
  for (int round = 0; round < 400; ++round) {
    const int window = 2 * random.between(1, 15) + 1;
    const int width = 4 * random.between(4, 20);
    expect_same_search(width, random.between(window, window + 8), window, random.between(1, 12), random);
  }
  expect_same_search(640, 60, 7, 80, random);
}

}  // namespace
}  // namespace stereotlm::kernels
