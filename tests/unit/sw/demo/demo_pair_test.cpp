#include <gtest/gtest.h>

#include <stdexcept>

#include "sw/demo/demo_pictures.h"

namespace stereotlm::demo {
namespace {

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
