#include "calib/drawings.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace stereotlm::calib {
namespace {

using kernels::GrayImage;
using kernels::RectificationTable;

constexpr int kMargin = 8;
constexpr int kTop = 32;   // of the pictures: margin and caption
constexpr int kEdge = 10;  // columns of parted() without source, on each side
const GridShape kShape{4, 3, 25};
const cv::Vec3b kWhite(255, 255, 255);
const cv::Vec3b kMissing(217, 217, 217);
const cv::Vec3b kOrange(0, 150, 255);
const cv::Vec3b kCyan(220, 200, 0);

cv::Mat3b decoded(const std::vector<std::uint8_t>& png) { return cv::imdecode(png, cv::IMREAD_UNCHANGED); }

// Counts the pixels of a colour. Smooth edges change it a little.
int count(const cv::Mat& picture, const cv::Vec3b& color) {
  const cv::Scalar tolerance = cv::Scalar::all(32);
  cv::Mat close;
  cv::inRange(picture, cv::Scalar(color) - tolerance, cv::Scalar(color) + tolerance, close);
  return cv::countNonZero(close);
}

bool is(const cv::Mat3b& picture, cv::Point pixel, const cv::Vec3b& color) {
  return count(picture(cv::Rect(pixel, cv::Size(1, 1))), color) == 1;
}

constexpr int kWidth = 200;
constexpr int kHeight = 160;
constexpr int kRight = kMargin + kWidth + kMargin;  // where the right picture begins

// Corners 30 pixels apart; the first at (40, 50).
Corners corners_in_rows() {
  Corners corners;
  for (int i = 0; i < kShape.corners(); ++i)
    corners.emplace_back(40 + 30 * (i % kShape.columns), 50 + 30 * (i / kShape.columns));
  return corners;
}

// The drawings of two pictures in grey 90 and 180, as number 7 of a calibration.
struct Drawn {
  CalibrationRequest request;
  CalibrationResult result;

  Drawn() {
    const PicturePair pictures = {"dir/a.png", "", GrayImage(kWidth, kHeight, 90),
                                  GrayImage(kWidth, kHeight, 180)};
    request.grid = kShape;
    request.pictures.assign(8, pictures);
    result.pairs = {{7, {corners_in_rows(), corners_in_rows()}, std::vector<bool>(12, true)}};
    result.tables = {kernels::identity_table(kWidth, kHeight), kernels::identity_table(kWidth, kHeight)};
  }

  cv::Mat3b picture(const std::string& name) const { return decoded(drawings(request, result).at(name)); }
};

cv::Mat3b displacement(const RectificationTable& left, const RectificationTable& right) {
  Drawn drawn;
  drawn.result.pairs.clear();
  drawn.result.tables = {left, right};
  return drawn.picture("displacement.png");
}

// A table whose sources lie `distance` columns to the right.
RectificationTable shifted(int width, int height, int distance) {
  RectificationTable table{width, height, {}};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const bool inside = column + distance < width;
      table.entries.push_back(inside ? kernels::make_entry(column + distance, row) : 0);
    }
  }
  return table;
}

// A table that moves everything by (offset, 1), its left half by `residual` further to the right and its
// right half by as much less. Columns that would leave the picture have no source.
RectificationTable parted(int width, int height, int offset, int residual) {
  RectificationTable table{width, height, {}};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const int source = column + offset + (column < width / 2 ? residual : -residual);
      const bool inside = column >= kEdge && column < width - kEdge && row + 1 < height;
      table.entries.push_back(inside ? kernels::make_entry(source, row + 1) : 0);
    }
  }
  return table;
}

cv::Vec3b viridis(int level) {
  const cv::Mat levels(1, 1, CV_8U, cv::Scalar(level));
  cv::Mat color;
  cv::applyColorMap(levels, color, cv::COLORMAP_VIRIDIS);
  return color.at<cv::Vec3b>(0, 0);
}

TEST(Drawings, AreThoseOfPairsWithAGridAndOfTheTables) {
  const Drawn drawn;
  std::vector<std::string> names;
  for (const auto& [name, png] : drawings(drawn.request, drawn.result)) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"corners_07.png", "displacement.png", "rectified_07.png"}));
}

TEST(CornersDrawing, JoinsTheCornersOfBothSidesAndMarksTheFirst) {
  const cv::Mat3b drawing = Drawn().picture("corners_07.png");
  for (const int left : {kMargin, kRight}) {
    const cv::Vec3b empty = left == kMargin ? cv::Vec3b(90, 90, 90) : cv::Vec3b(180, 180, 180);
    for (const int row : {0, 1, 2}) {
      EXPECT_FALSE(is(drawing, {left + 40 + 15, kTop + 50 + 30 * row}, empty));
      EXPECT_TRUE(is(drawing, {left + 40 + 15, kTop + 50 + 30 * row + 8}, empty));
    }
    EXPECT_TRUE(is(drawing, {left + 40, kTop + 50 - 8}, kOrange));
    EXPECT_TRUE(is(drawing, {left + 70, kTop + 50 - 8}, empty));
  }
}

TEST(CornersDrawing, CrossesOutCornersThatAreLeftOut) {
  Drawn drawn;
  const cv::Mat3b before = drawn.picture("corners_07.png");
  drawn.result.pairs.front().used[6] = false;
  cv::Mat changed;
  cv::absdiff(before, drawn.picture("corners_07.png"), changed);
  cv::Mat1b any;
  cv::transform(changed, any, cv::Matx13f(1, 1, 1));
  const cv::Rect around(100 - 8, 80 - 8, 17, 17);
  for (const cv::Point& picture : {cv::Point(kMargin, kTop), cv::Point(kRight, kTop)})
    EXPECT_GT(cv::countNonZero(any(around + picture)), 20);
  EXPECT_EQ(cv::countNonZero(any), cv::countNonZero(any(around + cv::Point(kMargin, kTop))) +
                                       cv::countNonZero(any(around + cv::Point(kRight, kTop))));
}

TEST(RectifiedDrawing, HasLinesThroughTheSameRowsOfBothPictures) {
  const cv::Mat3b drawing = Drawn().picture("rectified_07.png");
  for (const int left : {kMargin, kRight}) {
    EXPECT_EQ(count(drawing({left, kTop + 16, kWidth, 1}), kOrange), kWidth);
    EXPECT_EQ(count(drawing({left, kTop + 48, kWidth, 1}), kCyan), kWidth);
    EXPECT_EQ(count(drawing({left, kTop + 80, kWidth, 1}), kOrange), kWidth);
  }
  EXPECT_EQ(count(drawing({kMargin, kTop, kWidth, kHeight}), {90, 90, 90}), kWidth * (kHeight - 5));
}

TEST(RectifiedDrawing, IsRectifiedByTheTables) {
  Drawn drawn;
  drawn.request.pictures[7].right.at(60, 20) = 10;
  drawn.result.tables.right = shifted(kWidth, kHeight, 25);
  const cv::Mat3b drawing = drawn.picture("rectified_07.png");
  EXPECT_TRUE(is(drawing, {kRight + 35, kTop + 20}, cv::Vec3b(10, 10, 10)));
}

TEST(DisplacementDrawing, ColorsTheDistanceWithoutTheOffsetOnOneScale) {
  const cv::Mat3b drawing = displacement(parted(200, 80, 7, 2), parted(200, 80, 5, 4));
  const int right = kMargin + 300 + kMargin;                        // the scale is 300 pixels wide
  EXPECT_TRUE(is(drawing, {kMargin + kEdge, kTop}, viridis(128)));  // half of the largest distance
  EXPECT_TRUE(is(drawing, {kMargin + 199 - kEdge, kTop + 78}, viridis(128)));
  EXPECT_TRUE(is(drawing, {right + kEdge, kTop}, viridis(255)));
  EXPECT_TRUE(is(drawing, {right + 199 - kEdge, kTop + 78}, viridis(255)));
  for (const int left : {kMargin, right}) {
    EXPECT_TRUE(is(drawing, {left + kEdge - 1, kTop}, kMissing));
    EXPECT_TRUE(is(drawing, {left + 200 - kEdge, kTop}, kMissing));
    EXPECT_TRUE(is(drawing, {left + kEdge, kTop + 79}, kMissing));
  }
}

TEST(DisplacementDrawing, HasArrowsWithoutTheOffsetThatDoNotReachTheNext) {
  // Arrows begin 40 pixels apart. The longest distance is 4 pixels, so 9 times as long is the most that fits.
  const cv::Mat3b drawing = displacement(parted(200, 80, 7, 2), parted(200, 80, 5, 4));
  const int right = kMargin + 300 + kMargin;  // the scale is 300 pixels wide
  for (const int y : {20, 60}) {
    EXPECT_EQ(count(drawing({right + 21, kTop + y, 33, 1}), kWhite), 33);  // to the right, in the left half
    EXPECT_FALSE(is(drawing, {right + 59, kTop + y}, kWhite));
    EXPECT_FALSE(is(drawing, {right + 24, kTop + y - 2}, kWhite));
    EXPECT_EQ(count(drawing({right + 147, kTop + y, 33, 1}), kWhite), 33);  // and to the left in the other
    EXPECT_EQ(count(drawing({kMargin + 21, kTop + y, 15, 1}), kWhite), 15);
    EXPECT_FALSE(is(drawing, {kMargin + 41, kTop + y}, kWhite));
  }
}

TEST(DisplacementDrawing, ShowsTablesOfAnySizeWhatTheyMoveAndWithoutAnyEntry) {
  for (const int height : {1, 600}) {
    const RectificationTable table = kernels::identity_table(4, height);
    EXPECT_NO_THROW(displacement(table, table));
  }
  const RectificationTable empty{4, 1, std::vector<std::uint32_t>(4)};
  EXPECT_EQ(count(displacement(empty, empty)({kMargin, kTop, 4, 1}), kMissing), 4);
}

TEST(DepthColors, AreBrightForNearAndGreyForUnknownWithTheScaleBelow) {
  constexpr int kColumns = 400;
  std::vector<std::uint16_t> depths(3 * kColumns, 0);
  for (std::size_t i = 0; i < kColumns; ++i) depths[i] = i < kColumns / 2 ? 500 : 1500;
  depths[kColumns] = 1000;
  // Among 402 depths, four beyond each end are clamped.
  depths[2 * kColumns] = 10;
  const cv::Mat3b drawing = decoded(encode_depth_color_png(kColumns, 3, depths));
  EXPECT_EQ(drawing.size(), cv::Size(kColumns, 3 + 28));
  EXPECT_TRUE(is(drawing, {0, 0}, viridis(255)));
  EXPECT_TRUE(is(drawing, {kColumns - 1, 0}, viridis(0)));
  EXPECT_TRUE(is(drawing, {0, 1}, viridis(128)));
  EXPECT_TRUE(is(drawing, {0, 2}, viridis(255)));
  EXPECT_EQ(count(drawing({1, 1, kColumns - 1, 1}), kMissing), kColumns - 1);
  const cv::Mat below = drawing({0, 3, kColumns, 28});
  for (const int level : {0, 128, 255}) EXPECT_GT(count(below, viridis(level)), 0);
  EXPECT_GT(count(below, {0, 0, 0}), 20) << "the text";
  EXPECT_EQ(count(decoded(encode_depth_color_png(2, 2, {0, 0, 0, 0}))({0, 0, 2, 2}), kMissing), 4);
}

}  // namespace
}  // namespace stereotlm::calib
