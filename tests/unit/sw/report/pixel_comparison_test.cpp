#include "sw/report/pixel_comparison.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace stereotlm::report {
namespace {

using kernels::GrayImage;

TEST(PixelComparison, CountsPixelsAndNamesTheFirst) {
  PixelComparison pixels;
  const GrayImage a(4, 2, 7);
  GrayImage b = a;
  pixels.add(3, a, b);
  EXPECT_EQ(pixels.frames(), 1U);
  EXPECT_EQ(pixels.frames_that_differ(), 0U);
  EXPECT_EQ(pixels.pixels(), 0U);
  EXPECT_FALSE(pixels.first());
  b.at(2, 1) = 255;
  b.at(3, 0) = 6;
  pixels.add(5, a, b);
  pixels.add(6, a, b);
  EXPECT_EQ(pixels.frames(), 3U);
  EXPECT_EQ(pixels.frames_that_differ(), 2U);
  EXPECT_EQ(pixels.pixels(), 4U);
  ASSERT_TRUE(pixels.first());
  EXPECT_EQ(pixels.first()->camera_frame, 5U);
  EXPECT_EQ(pixels.first()->column, 3);
  EXPECT_EQ(pixels.first()->row, 0);
  EXPECT_EQ(pixels.first()->a, 7);
  EXPECT_EQ(pixels.first()->b, 6);
}

TEST(PixelComparison, RefusesPicturesOfDifferentSizes) {
  PixelComparison pixels;
  EXPECT_THROW(pixels.add(0, GrayImage(4, 2), GrayImage(8, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::report
