#include "sw/report/accuracy.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace stereotlm::report {
namespace {

using Row = std::vector<std::uint8_t>;

constexpr std::uint8_t kNone = 255;

kernels::GrayImage row(Row pixels) {
  kernels::GrayImage image(static_cast<int>(pixels.size()), 1);
  image.pixels = std::move(pixels);
  return image;
}

Accuracy of(Row disparity, Row truth, double scale = 1) {
  return accuracy(row(std::move(disparity)), {row(std::move(truth)), scale});
}

TEST(Accuracy, CountsAnErrorOfMoreThanOneAsBad) {
  const Accuracy result = of({0, 0, 0, 0, 3, 4, 2, 1}, {0, 0, 0, 0, 2, 2, 2, 2});
  EXPECT_EQ(result.bad_1_percent, 25);  // 4 for 2; 3 and 1 are off by just 1
  EXPECT_EQ(result.bad_2_percent, 0);   // off by just 2
  EXPECT_EQ(result.answered_percent, 100);
}

TEST(Accuracy, CountsAnErrorOfMoreThanTwoAsBadTwiceOver) {
  const Accuracy result = of({0, 0, 0, 0, 5, 4, 2, 0}, {0, 0, 0, 0, 2, 2, 2, 2});
  EXPECT_EQ(result.bad_1_percent, 75);
  EXPECT_EQ(result.bad_2_percent, 25);
}

TEST(Accuracy, ComparesWithTheFractionOfADisparity) {
  // Truth 2.25: 1 is off by 1.25, 3 by 0.75.
  EXPECT_EQ(of({kNone, kNone, kNone, 1}, {0, 0, 0, 9}, 4).bad_1_percent, 100);
  EXPECT_EQ(of({kNone, kNone, kNone, 3}, {0, 0, 0, 9}, 4).bad_1_percent, 0);
}

TEST(Accuracy, LeavesUnansweredPixelsOutOfTheBadOnes) {
  const Accuracy result = of({0, 0, kNone, 9}, {0, 0, 1, 1});
  EXPECT_EQ(result.bad_1_percent, 100);
  EXPECT_EQ(result.answered_percent, 50);
}

TEST(Accuracy, LeavesUnknownPixelsOut) {
  const Accuracy result = of({9, kNone, 9, 1}, {0, 0, 0, 1});
  EXPECT_EQ(result.bad_1_percent, 0);
  EXPECT_EQ(result.answered_percent, 100);
}

TEST(Accuracy, LeavesPixelsOutThatTheRightPictureDoesNotHold) {
  // x - truth: -1 is outside, 0 is the first column.
  EXPECT_EQ(of({9}, {1}).answered_percent, std::nullopt);
  EXPECT_EQ(of({kNone, 1}, {0, 1}).answered_percent, 100);
  // -0.5 rounds up to column 0, -0.75 is outside.
  EXPECT_EQ(of({1}, {2}, 4).answered_percent, 100);
  EXPECT_EQ(of({1}, {3}, 4).answered_percent, std::nullopt);
}

TEST(Accuracy, LeavesPixelsOutThatANearerOneHides) {
  // Pixels 3 and 5 of the row meet in right column 2 if their truths are 1 and 3.
  const Accuracy hidden = of({0, 0, 0, kNone, 0, 3}, {0, 0, 0, 1, 0, 3});
  EXPECT_EQ(hidden.answered_percent, 100) << "the unanswered one is occluded";
  // Pixels 3 and 4, truths 1 and 2: larger by just 1 hides nothing.
  const Accuracy seen = of({0, 0, 0, kNone, 2}, {0, 0, 0, 1, 2});
  EXPECT_EQ(seen.answered_percent, 50);
}

TEST(Accuracy, ComparesTruthsWithoutRoundingError) {
  // Thirds: 10/3 - 7/3 is 1 exactly, whatever doubles make of it; both meet in right column 6 or 7.
  for (int grey = 1; grey + 3 <= 60; ++grey) {
    Row disparity(40, kNone);
    Row truth(40, 0);
    truth[30] = static_cast<std::uint8_t>(grey);
    truth[31] = static_cast<std::uint8_t>(grey + 3);
    EXPECT_EQ(of(disparity, truth, 3).answered_percent, 0) << grey;
    disparity[31] = 1;  // one of two known and visible ones
    EXPECT_EQ(of(disparity, truth, 3).answered_percent, 50) << grey;
  }
}

TEST(Accuracy, LetsANearerOneOutsideThePictureHideNothing) {
  // Pixel 0 (truth 9) lands in column -9, pixel 1 (truth 1) in column 0.
  EXPECT_EQ(of({kNone, kNone}, {9, 1}).answered_percent, 0);
}

TEST(Accuracy, OccludesWithinARowOnly) {
  kernels::GrayImage truth(4, 2, 0);
  truth.at(1, 0) = 1;
  truth.at(3, 1) = 3;
  EXPECT_EQ(accuracy(kernels::GrayImage(4, 2, kNone), {truth, 1}).answered_percent, 0);
  kernels::GrayImage disparity(4, 2, kNone);
  disparity.at(3, 1) = 3;
  EXPECT_EQ(accuracy(disparity, {truth, 1}).answered_percent, 50);
}

TEST(Accuracy, HasNoPercentageOfNothing) {
  const Accuracy unknown = of({1, 2}, {0, 0});
  EXPECT_FALSE(unknown.bad_1_percent || unknown.bad_2_percent || unknown.answered_percent);
  const Accuracy unanswered = of({kNone, kNone}, {0, 1});
  EXPECT_FALSE(unanswered.bad_1_percent || unanswered.bad_2_percent);
  EXPECT_EQ(unanswered.answered_percent, 0);
}

TEST(Accuracy, RefusesATruthOfAnotherSize) {
  EXPECT_THROW(of({1, 2}, {1}), std::invalid_argument);
  EXPECT_THROW(accuracy(kernels::GrayImage(1, 2), {kernels::GrayImage(1, 1), 1}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::report
