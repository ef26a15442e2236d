#include "tests/support/reference_arithmetic.h"

#include <gtest/gtest.h>

#include <utility>

namespace stereotlm::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Entries = std::vector<std::uint32_t>;

constexpr std::uint32_t kValid = 0x8000'0000U;

std::uint32_t entry(std::uint32_t column, std::uint32_t row) { return kValid | row << 16U | column; }

// The same row of pixels, repeated.
Bytes rows_of(const Bytes& row, int count) {
  Bytes pixels;
  for (int repeat = 0; repeat < count; ++repeat) pixels.insert(pixels.end(), row.begin(), row.end());
  return pixels;
}

ReferenceInput input_of(int width, int height, Bytes left, Bytes right) {
  ReferenceInput input;
  input.width = width;
  input.height = height;
  input.left = std::move(left);
  input.right = std::move(right);
  input.window = 3;
  input.disparities = 1;
  return input;
}

TEST(ReferenceRectify, ReadsTheSourcePixelAndZeroWhereInvalid) {
  const Bytes source = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(reference_rectify(4, 2, source, std::nullopt), source);
  const Entries table = {entry(3, 1), entry(0, 1), 0,           0x0001'0002U,
                         entry(0, 0), entry(3, 0), entry(2, 1), entry(2, 1)};
  EXPECT_EQ(reference_rectify(4, 2, source, table), (Bytes{8, 5, 0, 0, 1, 4, 7, 7}));
}

TEST(ReferenceFilter, CorrelatesRepeatsTheEdgeAndRoundsDown) {
  const Bytes row = {10, 11, 11, 9};
  const ReferenceKernel from_left = {3, {0, 0, 0, 1, -1, 0, 0, 0, 0}, 1};
  EXPECT_EQ(reference_filter(4, 1, row, from_left), (Bytes{128, 127, 128, 129}));
  EXPECT_EQ(reference_filter(4, 1, row, std::nullopt), row);

  const Bytes two_rows = {0, 0, 0, 0, 1, 2, 3, 4};
  const ReferenceKernel from_above = {3, {0, 1, 0, 0, -1, 0, 0, 0, 0}, 0};
  EXPECT_EQ(reference_filter(4, 2, two_rows, from_above), (Bytes{128, 128, 128, 128, 127, 126, 125, 124}));
}

TEST(ReferenceFilter, ClampsToAByte) {
  const Bytes row = {0, 128, 255, 0};
  const ReferenceKernel from_left = {3, {0, 0, 0, 1, -1, 0, 0, 0, 0}, 0};
  EXPECT_EQ(reference_filter(4, 1, row, from_left), (Bytes{128, 0, 1, 255}));
  EXPECT_EQ(reference_filter(4, 1, {0, 129, 255, 128}, from_left), (Bytes{128, 0, 2, 255}));
}

TEST(ReferenceFilter, SumsBeyondThirtyTwoBits) {
  ReferenceKernel kernel{31, {}, 31};
  for (int j = 0; j < 31; ++j) {
    for (int i = -15; i <= 15; ++i) kernel.weights.push_back(i == 0 ? 0 : (i < 0 ? 32767 : -32767));
  }
  Bytes bright_left(64, 0);
  for (std::size_t column = 0; column < 32; ++column) bright_left[column] = 255;
  const Bytes bright_right(bright_left.rbegin(), bright_left.rend());
  // S = +-465 * 32767 * 255 = +-1.81 * 2^31 at the step.
  EXPECT_EQ(reference_filter(64, 1, bright_left, kernel)[31], 129);
  EXPECT_EQ(reference_filter(64, 1, bright_right, kernel)[31], 126);
}

TEST(ReferenceMatch, FindsTheShiftInBothDirections) {
  // right(x) = left(x + 2)
  const Bytes left = {0, 10, 30, 70, 150, 40, 200, 90};
  const Bytes right = {30, 70, 150, 40, 200, 90, 5, 250};
  ReferenceInput input = input_of(8, 3, rows_of(left, 3), rows_of(right, 3));
  input.disparities = 4;
  const ReferenceResult result = compute_reference(input);
  const auto row = [](const std::vector<int>& image, std::ptrdiff_t y) {
    return std::vector<int>(image.begin() + y * 8, image.begin() + y * 8 + 8);
  };
  const std::vector<int> none(8, -1);
  EXPECT_EQ(row(result.right_based, 0), none);  // the window leaves the picture
  EXPECT_EQ(row(result.left_based, 2), none);
  const std::vector<int> right_based = row(result.right_based, 1);
  for (const int x : {1, 2, 3, 4}) EXPECT_EQ(right_based[static_cast<std::size_t>(x)], 2) << x;
  EXPECT_EQ(right_based[0], -1);
  EXPECT_EQ(right_based[6], 0);  // the only candidate
  EXPECT_EQ(right_based[7], -1);
  const std::vector<int> left_based = row(result.left_based, 1);
  for (const int x : {3, 4, 5, 6}) EXPECT_EQ(left_based[static_cast<std::size_t>(x)], 2) << x;
  EXPECT_EQ(left_based[0], -1);
  EXPECT_EQ(left_based[1], 0);  // the only candidate
  EXPECT_EQ(left_based[7], -1);
}

TEST(ReferenceMatch, LetsTheSmallestDisparityWinATie) {
  // Period 3, right(x) = left(x + 1): disparities 1, 4 and 7 fit equally well.
  const Bytes left = {0, 50, 200, 0, 50, 200, 0, 50, 200, 0, 50, 200};
  const Bytes right = {50, 200, 0, 50, 200, 0, 50, 200, 0, 50, 200, 0};
  ReferenceInput input = input_of(12, 3, rows_of(left, 3), rows_of(right, 3));
  input.disparities = 254;
  const ReferenceResult result = compute_reference(input);
  for (std::size_t x = 1; x <= 9; ++x) EXPECT_EQ(result.right_based[12 + x], 1) << x;
  for (std::size_t x = 2; x <= 10; ++x) EXPECT_EQ(result.left_based[12 + x], 1) << x;
}

TEST(ReferenceMatch, FindsNothingWhereTheWindowDoesNotFit) {
  ReferenceInput input = input_of(4, 2, Bytes(8, 9), Bytes(8, 9));
  EXPECT_EQ(compute_reference(input).disparity, Bytes(8, 255));
  input = input_of(4, 3, Bytes(12, 9), Bytes(12, 9));
  EXPECT_EQ(compute_reference(input).disparity,
            (Bytes{255, 255, 255, 255, 255, 0, 0, 255, 255, 255, 255, 255}));
  input.window = 31;
  EXPECT_EQ(compute_reference(input).disparity, Bytes(12, 255));
}

// SAD depends on the right pixel alone. At left pixel 3, d = 1 (right pixel 2, sum 0) beats d = 0 (right
// pixel 3, sum 27); at right pixel 2 both sums are 0 and d = 0 wins: the two searches differ by 1.
ReferenceInput differing_by_one() {
  ReferenceInput input = input_of(8, 3, Bytes(24, 0), rows_of({0, 0, 0, 0, 9, 9, 9, 9}, 3));
  input.disparities = 2;
  return input;
}
constexpr std::size_t kDifferingPixel = 8 + 3;

TEST(ReferenceCheck, ComparesTheTwoSearchesWithinTheTolerance) {
  ReferenceInput input = differing_by_one();
  EXPECT_EQ(compute_reference(input).left_based[kDifferingPixel], 1);
  EXPECT_EQ(compute_reference(input).right_based[kDifferingPixel - 1], 0);
  EXPECT_EQ(compute_reference(input).disparity[kDifferingPixel], 1);  // off
  input.lr_tolerance = 0;
  EXPECT_EQ(compute_reference(input).disparity[kDifferingPixel], 255);
  input.lr_tolerance = 1;
  EXPECT_EQ(compute_reference(input).disparity[kDifferingPixel], 1);
}

TEST(ReferenceCheck, InvalidatesOnlyThePixelWhoseOwnLeftEntryIsInvalid) {
  ReferenceInput input = differing_by_one();
  const Bytes without_table = compute_reference(input).disparity;
  Entries identity;
  for (std::uint32_t y = 0; y < 3; ++y) {
    for (std::uint32_t x = 0; x < 8; ++x) identity.push_back(entry(x, y));
  }
  input.left_table = identity;
  input.right_table = identity;
  EXPECT_EQ(compute_reference(input).disparity, without_table);

  (*input.left_table)[kDifferingPixel] = 0;  // its pixel reads as 0, which it was before
  Bytes expected = without_table;
  expected[kDifferingPixel] = 255;
  EXPECT_EQ(compute_reference(input).disparity, expected);

  (*input.left_table)[kDifferingPixel] = identity[kDifferingPixel];
  (*input.right_table)[kDifferingPixel] = 0;  // likewise, on the right side
  EXPECT_EQ(compute_reference(input).disparity, without_table);
}

TEST(ReferenceCheck, LetsOtherInvalidEntriesTakePartAsZero) {
  ReferenceInput input = differing_by_one();
  EXPECT_EQ(compute_reference(input).disparity[kDifferingPixel], 1);
  Entries table;
  for (std::uint32_t y = 0; y < 3; ++y) {
    for (std::uint32_t x = 0; x < 8; ++x) table.push_back(x == 4 ? 0 : entry(x, y));
  }
  input.right_table = table;  // the column whose 9s made d = 0 worse
  EXPECT_EQ(compute_reference(input).disparity[kDifferingPixel], 0);
}

TEST(ReferenceWords, PutTheLowestColumnIntoTheLowestByte) {
  EXPECT_EQ(reference_words({1, 2, 3, 4, 0xFF, 0, 0, 0xFE}), (Entries{0x0403'0201U, 0xFE00'00FFU}));
  const ReferenceResult result = compute_reference(input_of(4, 3, Bytes(12, 9), Bytes(12, 9)));
  EXPECT_EQ(result.disparity_words, (Entries{0xFFFF'FFFFU, 0xFF00'00FFU, 0xFFFF'FFFFU}));
}

}  // namespace
}  // namespace stereotlm::test
