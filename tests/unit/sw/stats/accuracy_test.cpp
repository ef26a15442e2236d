#include "sw/stats/accuracy.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace stereotlm::stats {
namespace {

using Row = std::vector<std::uint8_t>;

constexpr std::uint8_t kNone = 255;
constexpr std::nullopt_t kNothing = std::nullopt;

kernels::GrayImage row(Row pixels) {
  kernels::GrayImage image(static_cast<int>(pixels.size()), 1);
  image.pixels = std::move(pixels);
  return image;
}

Accuracy of(Row disparity, Row truth, double scale = 1) {
  return accuracy(row(std::move(disparity)), {row(std::move(truth)), scale});
}

struct RowCase {
  const char* claim;
  Row disparity;
  Row truth;
  Accuracy expected;
  double scale = 1;
};

TEST(Accuracy, CountsTheKnownVisiblePixelsOfARow) {
  const std::vector<RowCase> cases = {
      {"bad: more than 1 off", {0, 0, 0, 0, 3, 4, 2, 1}, {0, 0, 0, 0, 2, 2, 2, 2}, {25, 0, 100}},
      {"bad: more than 2 off", {0, 0, 0, 0, 5, 4, 2, 0}, {0, 0, 0, 0, 2, 2, 2, 2}, {75, 25, 100}},
      {"a truth of 2.25 and an error of 1.25", {kNone, kNone, kNone, 1}, {0, 0, 0, 9}, {100, 0, 100}, 4},
      {"a truth of 2.25 and an error of 0.75", {kNone, kNone, kNone, 3}, {0, 0, 0, 9}, {0, 0, 100}, 4},
      {"an unanswered pixel is not bad", {0, 0, kNone, 9}, {0, 0, 1, 1}, {100, 100, 50}},
      {"unknown pixels do not count", {9, kNone, 9, 1}, {0, 0, 0, 1}, {0, 0, 100}},
      {"all pixels are unknown", {1, 2}, {0, 0}, {kNothing, kNothing, kNothing}},
      {"no pixel is answered", {kNone, kNone}, {0, 1}, {kNothing, kNothing, 0}},
      {"column -1 of the right picture does not exist", {9}, {1}, {kNothing, kNothing, kNothing}},
      {"column 0 of the right picture exists", {kNone, 1}, {0, 1}, {0, 0, 100}},
      {"column -0.5 rounds up to 0", {1}, {2}, {0, 0, 100}, 4},
      {"column -0.75 is outside", {1}, {3}, {kNothing, kNothing, kNothing}, 4},
      // Pixels 3 and 5 lie in right column 2.
      {"a nearer pixel occludes", {0, 0, 0, kNone, 0, 3}, {0, 0, 0, 1, 0, 3}, {0, 0, 100}},
      {"a pixel nearer by just 1 does not", {0, 0, 0, kNone, 2}, {0, 0, 0, 1, 2}, {0, 0, 50}},
      {"a nearer pixel outside occludes nothing", {kNone, kNone}, {9, 1}, {kNothing, kNothing, 0}},
  };
  for (const RowCase& one : cases) {
    SCOPED_TRACE(one.claim);
    const Accuracy found = of(one.disparity, one.truth, one.scale);
    EXPECT_EQ(found.bad_1_percent, one.expected.bad_1_percent);
    EXPECT_EQ(found.bad_2_percent, one.expected.bad_2_percent);
    EXPECT_EQ(found.answered_percent, one.expected.answered_percent);
  }
}

TEST(Accuracy, ComparesTruthsWithoutRoundingError) {
  // Thirds: 10/3 - 7/3 is exactly 1, although doubles round it. Both lie in right column 6 or 7.
  for (int grey = 1; grey + 3 <= 60; ++grey) {
    Row disparity(40, kNone);
    Row truth(40, 0);
    truth[30] = static_cast<std::uint8_t>(grey);
    truth[31] = static_cast<std::uint8_t>(grey + 3);
    EXPECT_EQ(of(disparity, truth, 3).answered_percent, 0) << grey;
    disparity[31] = 1;  // one of two known and visible pixels
    EXPECT_EQ(of(disparity, truth, 3).answered_percent, 50) << grey;
  }
}

TEST(Accuracy, OccludesWithinARowOnly) {
  kernels::GrayImage truth(4, 2, 0);
  truth.at(1, 0) = 1;
  truth.at(3, 1) = 3;
  kernels::GrayImage disparity(4, 2, kNone);
  EXPECT_EQ(accuracy(disparity, {truth, 1}).answered_percent, 0);
  disparity.at(3, 1) = 3;
  EXPECT_EQ(accuracy(disparity, {truth, 1}).answered_percent, 50);
}

TEST(Accuracy, RefusesATruthOfAnotherSize) {
  EXPECT_THROW(of({1, 2}, {1}), std::invalid_argument);
  EXPECT_THROW(accuracy(kernels::GrayImage(1, 2), {kernels::GrayImage(1, 1), 1}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::stats
