#include "tests/support/reference_arithmetic.h"

#include <gtest/gtest.h>

#include <stdexcept>
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

constexpr auto kSad = ReferenceCost::Kind::kSad;
constexpr auto kSsd = ReferenceCost::Kind::kSsd;
constexpr auto kZncc = ReferenceCost::Kind::kZncc;
constexpr auto kCensus = ReferenceCost::Kind::kCensus;

// The right-based disparity of pixel (1, 1) among 0 and 1, on three equal rows.
int best_of_two(const ReferenceCost& cost, const Bytes& left, const Bytes& right) {
  ReferenceInput input = input_of(4, 3, rows_of(left, 3), rows_of(right, 3));
  input.disparities = 2;
  input.cost = cost;
  return compute_reference(input).right_based[5];
}

TEST(ReferenceSsd, SumsSquares) {
  const Bytes left = {103, 102, 100, 100};
  const Bytes right = {100, 102, 100, 0};  // differences 3, 0, 0 with d = 0, and 2, 2, 0 with d = 1
  EXPECT_EQ(best_of_two({kSad}, left, right), 0);
  EXPECT_EQ(best_of_two({kSsd}, left, right), 1);
}

TEST(ReferenceZncc, PrefersTheGreatestCorrelation) {
  // d = 0: falls where the right picture rises. d = 1: rises likewise, but is brighter and steeper.
  EXPECT_EQ(best_of_two({kZncc}, {20, 0, 100, 200}, {0, 10, 20, 0}), 1);
  EXPECT_EQ(best_of_two({kSad}, {20, 0, 100, 200}, {0, 10, 20, 0}), 0);
}

TEST(ReferenceZncc, KeepsTheSignOfTheCovariance) {
  // d = 0: cov < 0. d = 1: cov < 0 too, but it is smaller beside the variances.
  EXPECT_EQ(best_of_two({kZncc}, {30, 10, 0, 9}, {0, 10, 20, 0}), 1);
}

TEST(ReferenceZncc, GivesAWindowWithoutVarianceTheScoreZero) {
  EXPECT_EQ(best_of_two({kZncc}, {9, 7, 7, 7}, {0, 10, 20, 0}), 1);  // cov < 0; var_l = 0
  EXPECT_EQ(best_of_two({kZncc}, {7, 7, 7, 8}, {0, 10, 20, 0}), 1);  // var_l = 0; cov > 0
  EXPECT_EQ(best_of_two({kZncc}, {7, 7, 7, 6}, {0, 10, 20, 0}), 0);  // var_l = 0; cov < 0
  EXPECT_EQ(best_of_two({kZncc}, {1, 2, 3, 9}, {5, 5, 5, 5}), 0);    // var_r = 0: a tie
}

TEST(ReferenceZncc, ComparesFractionsExactly) {
  // Both windows are right pictures scaled: the scores are 1, of different numerators and denominators.
  EXPECT_EQ(best_of_two({kZncc}, {3, 6, 12, 24}, {1, 2, 4, 0}), 0);
  // With d = 0 off by one in one pixel it is a tie no more.
  EXPECT_EQ(best_of_two({kZncc}, {4, 6, 12, 24}, {1, 2, 4, 0}), 1);
  EXPECT_EQ(best_of_two({kZncc}, {3, 6, 12, 25}, {1, 2, 4, 0}), 0);
}

TEST(ReferenceZncc, HoldsTheLargestFractions) {
  // The widest window, half of it black and half white: covariances of 34 bits. The left picture is the right
  // one, but for a corner; the shift by one is worse.
  Bytes right;
  for (int pixel = 0; pixel < 32 * 31; ++pixel) right.push_back(pixel % 32 < 16 ? 0 : 255);
  Bytes left = right;
  left.front() = 1;
  ReferenceInput input = input_of(32, 31, left, right);
  input.window = 31;
  input.disparities = 2;
  input.cost = {kZncc};
  const std::size_t middle = 15 * 32 + 15;
  EXPECT_EQ(compute_reference(input).right_based[middle], 0);
  for (int row = 0; row < 31; ++row) {  // now the shift by one
    for (int column = 31; column > 0; --column) {
      const auto place = static_cast<std::size_t>(32 * row + column);
      input.left[place] = input.right[place - 1];
    }
  }
  EXPECT_EQ(compute_reference(input).right_based[middle], 1);
}

TEST(ReferenceCensus, HasABitForEachSmallerNeighbourAndRepeatsTheEdge) {
  EXPECT_EQ(reference_census(4, 1, {5, 3, 5, 7}, 3), (std::vector<std::uint64_t>{0x94, 0, 0x29, 0x29}));
  // Four zeros in the upper left corner.
  const auto census = reference_census(4, 4, {0, 0, 9, 9, 0, 0, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9}, 5);
  EXPECT_EQ(census[10], 0x063U);  // all four, at j, i = -2, -1
  EXPECT_EQ(census[15], 0x001U);  // the one at j = i = -2
  EXPECT_EQ(census[8], 0x1EFU);   // column 0 three times, at i = -2, -1, 0, and column 1
  EXPECT_EQ(census[0], 0U);
  EXPECT_EQ(reference_census(4, 1, {5, 3, 5, 7}, 7)[0] >> 48U, 0U);
}

TEST(ReferenceCensus, CountsTheBitsThatDiffer) {
  // Right pixels rise; left ones rise too with d = 1, far brighter, but not with d = 0.
  EXPECT_EQ(best_of_two({kCensus, 3}, {50, 20, 60, 250}, {10, 20, 30, 40}), 1);
  EXPECT_EQ(best_of_two({kSad}, {50, 20, 60, 250}, {10, 20, 30, 40}), 0);
  EXPECT_EQ(best_of_two({kCensus, 3}, {7, 7, 7, 7}, {9, 9, 9, 9}), 0);  // a tie
}

TEST(ReferenceCost, LooksAheadOnlyWithCensus) {
  EXPECT_EQ(half_of({kSad}), 0);
  EXPECT_EQ(half_of({kZncc}), 0);
  EXPECT_EQ(half_of({kCensus, 3}), 1);
  EXPECT_EQ(half_of({kCensus, 7}), 3);
}

TEST(ReferenceJointTable, HoldsTheDisplacementsFromTheMiddleOfTheirRange) {
  // Left: displacements (2, 1) and (-1, 0), so the middle is (1, 1). Right: (-1, 0) and (-2, 1).
  const Entries left = {entry(2, 1), entry(0, 0), 0x0001'0002U, 0, 0, 0, 0, 0};
  const Entries right = {0, entry(0, 0), entry(0, 1), 0, 0, 0, 0, 0};
  const ReferenceJointTable table = reference_joint_table(4, left, right);
  EXPECT_EQ(table.left.x, 1);
  EXPECT_EQ(table.left.y, 1);
  EXPECT_EQ(table.right.x, -1);
  EXPECT_EQ(table.right.y, 1);
  EXPECT_EQ(table.words, (Entries{0xC081'0000U, 0xBF7E'BF80U, 0x0000'C07FU, 0, 0, 0, 0, 0}));
  EXPECT_EQ(reference_left_entries(4, table), (Entries{entry(2, 1), entry(0, 0), 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(reference_right_entries(4, table), right);
}

TEST(ReferenceJointTable, FitsARangeOf256ColumnsAnd128Rows) {
  const auto table_of = [](std::uint32_t column, std::uint32_t row) {
    Entries entries(std::size_t{4} * 200, 0);
    entries[0] = entry(0, 0);
    entries[1] = entry(1 + column, row);
    const ReferenceJointTable table = reference_joint_table(4, entries, Entries(entries.size(), 0));
    EXPECT_EQ(reference_left_entries(4, table), entries);
    EXPECT_EQ(table.right.x, 0);
    return table;
  };
  EXPECT_EQ(table_of(255, 127).left.x, 128);
  EXPECT_EQ(table_of(255, 127).left.y, 64);
  EXPECT_THROW(table_of(256, 0), std::invalid_argument);
  EXPECT_THROW(table_of(0, 128), std::invalid_argument);
}

TEST(ReferenceWords, PutTheLowestColumnIntoTheLowestByte) {
  EXPECT_EQ(reference_words({1, 2, 3, 4, 0xFF, 0, 0, 0xFE}), (Entries{0x0403'0201U, 0xFE00'00FFU}));
  const ReferenceResult result = compute_reference(input_of(4, 3, Bytes(12, 9), Bytes(12, 9)));
  EXPECT_EQ(result.disparity_words, (Entries{0xFFFF'FFFFU, 0xFF00'00FFU, 0xFFFF'FFFFU}));
}

}  // namespace
}  // namespace stereotlm::test
