#include "sw/media/truth.h"

#include <gtest/gtest.h>

namespace stereotlm::media {
namespace {

TEST(Truth, NeedsTheLargestDisparityRoundedUpAndZero) {
  Truth truth = {kernels::GrayImage(2, 1), 2};
  EXPECT_EQ(disparities_needed(truth), 1);
  truth.grey.at(1, 0) = 158;
  EXPECT_EQ(disparities_needed(truth), 80);
  truth.grey.at(0, 0) = 159;
  EXPECT_EQ(disparities_needed(truth), 81);
  truth.scale = 1.5;
  EXPECT_EQ(disparities_needed(truth), 107);
  truth.scale = 1e-300;
  EXPECT_GT(disparities_needed(truth), 1e300);
}

}  // namespace
}  // namespace stereotlm::media
