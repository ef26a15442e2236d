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
const cv::Vec3b kYellow(0, 220, 220);
const cv::Vec3b kCyan(220, 200, 0);
const cv::Vec3b kRed(0, 0, 255);

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

// Corners 30 pixels apart; the first at (40, 50).
MarkedCorners marked_corners() {
  MarkedCorners marked;
  for (int i = 0; i < kShape.corners(); ++i) {
    marked.corners.emplace_back(40 + 30 * (i % kShape.columns), 50 + 30 * (i / kShape.columns));
  }
  return marked;
}

// Draws on two empty pictures of 200 x 160 in grey 90.
cv::Mat3b drawn_corners(const MarkedCorners& left, const MarkedCorners& right) {
  const GrayImage image(200, 160, 90);
  return decoded(encode_corners_png(kShape, {"left", image}, left, {"right", image}, right));
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

TEST(CornersDrawing, ShowsBothPicturesUnderTheirCaptions) {
  const GrayImage left(200, 160, 90);
  const GrayImage right(200, 160, 180);
  const cv::Mat3b drawing = decoded(encode_corners_png(kShape, {"a.png", left}, {}, {"", right}, {}));
  EXPECT_EQ(drawing.size(), cv::Size(3 * kMargin + 2 * 200, kTop + 160 + kMargin));
  EXPECT_EQ(count(drawing({kMargin, kTop, 200, 160}), {90, 90, 90}), 200 * 160);
  EXPECT_TRUE(is(drawing, {kMargin, kTop}, cv::Vec3b(90, 90, 90)));
  EXPECT_TRUE(is(drawing, {kMargin + 199 + kMargin + 200, kTop + 159}, cv::Vec3b(180, 180, 180)));
  EXPECT_LT(count(drawing({kMargin, 0, 200, kTop}), kWhite), 200 * kTop);
  EXPECT_EQ(count(drawing({kMargin + 200 + kMargin, 0, 200, kTop}), kWhite), 200 * kTop);
}

TEST(CornersDrawing, JoinsTheCornersOfARowInItsColor) {
  const cv::Mat3b drawing = drawn_corners(marked_corners(), {});
  EXPECT_TRUE(is(drawing, {kMargin + 40 + 15, kTop + 50}, kOrange));
  EXPECT_TRUE(is(drawing, {kMargin + 40 + 15, kTop + 50 + 30}, kYellow));
  // More than the line: a circle too.
  EXPECT_GT(count(drawing({kMargin + 95, kTop + 45, 11, 11}), kOrange), 11 + 4);
  const cv::Rect right(kMargin + 200 + kMargin, kTop, 200, 160);
  EXPECT_EQ(count(drawing(right), {90, 90, 90}), 200 * 160);
}

TEST(CornersDrawing, MarksTheFirstCornerWithASquare) {
  const cv::Mat3b drawing = drawn_corners({}, marked_corners());
  const int left = kMargin + 200 + kMargin;
  EXPECT_TRUE(is(drawing, {left + 40, kTop + 50 - 8}, kOrange));
  EXPECT_TRUE(is(drawing, {left + 40 - 8, kTop + 50 + 5}, kOrange));
  EXPECT_TRUE(is(drawing, {left + 70, kTop + 50 - 8}, cv::Vec3b(90, 90, 90)));
}

TEST(CornersDrawing, CrossesOutCornersThatAreLeftOut) {
  MarkedCorners left = marked_corners();
  left.left_out.assign(left.corners.size(), false);
  EXPECT_EQ(count(drawn_corners(left, left), kRed), 0);
  left.left_out[6] = true;
  const cv::Mat3b drawing = drawn_corners(left, marked_corners());
  EXPECT_TRUE(is(drawing, {kMargin + 100, kTop + 80}, kRed));
  EXPECT_TRUE(is(drawing, {kMargin + 100 + 3, kTop + 80 - 3}, kRed));
  EXPECT_EQ(count(drawing, kRed), count(drawing({kMargin + 92, kTop + 72, 17, 17}), kRed));
}

TEST(CornersDrawing, ShowsNamesInAnyLettersInTheirWidth) {
  const GrayImage image(320, 80, 90);
  const auto inked = [&image](const std::string& caption) {
    const cv::Mat3b drawing = decoded(encode_corners_png(kShape, {caption, image}, {}, {"", image}, {}));
    EXPECT_EQ(count(drawing({kMargin + 320 + kMargin, 0, 320, kTop}), kWhite), 320 * kTop);
    EXPECT_EQ(count(drawing({kMargin + 320, 0, kMargin, kTop}), kWhite), kMargin * kTop);
    return 320 * kTop - count(drawing({kMargin, 0, 320, kTop}), kWhite);
  };
  EXPECT_GT(inked("\xc3\xa4\xc3\xb6\xc3\xbc"), inked("aou"));             // umlauts have dots
  EXPECT_EQ(inked("a\xff\xfe"), inked("a??"));                            // no UTF-8
  EXPECT_EQ(inked(std::string(300, 'm')), inked(std::string(200, 'm')));  // cut off
  EXPECT_EQ(inked(""), 0);
}

TEST(RectifiedPairDrawing, HasLinesThroughBothPictures) {
  const CaptionedImage image{"a", GrayImage(400, 100, 90)};
  const cv::Mat3b drawing = decoded(encode_rectified_pair_png(image, image));
  const int left = kMargin;
  const int width = 400 + kMargin + 400;
  EXPECT_EQ(count(drawing({left, kTop + 16, width, 1}), kOrange), width);
  EXPECT_EQ(count(drawing({left, kTop + 48, width, 1}), kCyan), width);
  EXPECT_EQ(count(drawing({left, kTop + 80, width, 1}), kOrange), width);
  EXPECT_EQ(count(drawing({left, kTop, 400, 100}), {90, 90, 90}), 400 * (100 - 3));
}

TEST(DisplacementDrawing, ColorsTheDistanceWithoutTheOffsetOnOneScale) {
  const cv::Mat3b drawing = decoded(encode_displacement_png(parted(200, 80, 7, 2), parted(200, 80, 5, 4)));
  EXPECT_EQ(drawing.cols, 3 * kMargin + 2 * 200);
  const int right = kMargin + 200 + kMargin;
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
  // Arrows begin 40 pixels apart. The longest distance is 4 pixels, so 5 times as long is the most that fits.
  const cv::Mat3b drawing = decoded(encode_displacement_png(parted(200, 80, 7, 2), parted(200, 80, 5, 4)));
  const int right = kMargin + 200 + kMargin;
  for (const int y : {20, 60}) {
    EXPECT_EQ(count(drawing({right + 21, kTop + y, 17, 1}), kWhite), 17);  // to the right, in the left half
    EXPECT_FALSE(is(drawing, {right + 43, kTop + y}, kWhite));
    EXPECT_FALSE(is(drawing, {right + 24, kTop + y - 2}, kWhite));
    EXPECT_TRUE(is(drawing, {right + 38, kTop + y - 2}, kWhite));  // the head is wider than the shaft
    EXPECT_EQ(count(drawing({right + 163, kTop + y, 17, 1}), kWhite), 17);  // and to the left in the other
    EXPECT_EQ(count(drawing({kMargin + 21, kTop + y, 7, 1}), kWhite), 7);
    EXPECT_FALSE(is(drawing, {kMargin + 33, kTop + y}, kWhite));
  }
}

TEST(DisplacementDrawing, ShowsTablesThatMoveNothingOrHaveNoValidEntry) {
  for (const RectificationTable& table : {kernels::identity_table(200, 80), shifted(200, 80, 10)}) {
    const cv::Mat3b drawing = decoded(encode_displacement_png(table, table));
    EXPECT_TRUE(is(drawing, {kMargin, kTop}, viridis(0)));
    EXPECT_FALSE(is(drawing, {kMargin + 20, kTop + 20}, viridis(0))) << "a dot";
    EXPECT_FALSE(is(drawing, {kMargin + 26, kTop + 20}, kWhite));
  }
  const RectificationTable empty{4, 1, std::vector<std::uint32_t>(4)};
  const cv::Mat3b of_empty = decoded(encode_displacement_png(empty, empty));
  EXPECT_EQ(count(of_empty({kMargin, kTop, 4, 1}), kMissing), 4);
}

TEST(DepthColors, AreBrightForNearAndGreyForUnknownWithTheScaleBelow) {
  constexpr int kWidth = 400;
  std::vector<std::uint16_t> depths(3 * kWidth, 0);
  for (std::size_t i = 0; i < kWidth; ++i) depths[i] = i < kWidth / 2 ? 500 : 1500;
  depths[kWidth] = 1000;
  // Among 402 depths, four beyond each end are clamped.
  depths[2 * kWidth] = 10;
  const cv::Mat3b drawing = decoded(encode_depth_color_png(kWidth, 3, depths));
  EXPECT_EQ(drawing.size(), cv::Size(kWidth, 3 + 28));
  EXPECT_TRUE(is(drawing, {0, 0}, viridis(255)));
  EXPECT_TRUE(is(drawing, {kWidth - 1, 0}, viridis(0)));
  EXPECT_TRUE(is(drawing, {0, 1}, viridis(128)));
  EXPECT_TRUE(is(drawing, {0, 2}, viridis(255)));
  EXPECT_EQ(count(drawing({1, 1, kWidth - 1, 1}), kMissing), kWidth - 1);
  const cv::Mat below = drawing({0, 3, kWidth, 28});
  for (const int level : {0, 128, 255}) EXPECT_GT(count(below, viridis(level)), 0);
  EXPECT_GT(count(below, {0, 0, 0}), 20) << "the text";
}

TEST(DepthColors, ShowPicturesWithoutAnyDepthAndNarrowOnes) {
  const cv::Mat3b drawing = decoded(encode_depth_color_png(2, 2, {0, 0, 0, 0}));
  EXPECT_EQ(count(drawing({0, 0, 2, 2}), kMissing), 4);
  EXPECT_GE(drawing.cols, 300);
  EXPECT_EQ(count(drawing({2, 0, drawing.cols - 2, 2}), kWhite), 2 * (drawing.cols - 2));
}

TEST(SourceLinesDrawing, HasACurveForEachTable) {
  RectificationTable bent = kernels::identity_table(8, 64);
  for (int row = 0; row + 12 < 64; ++row) {
    bent.entries[8 * static_cast<std::size_t>(row)] = kernels::make_entry(0, row + 12);
  }
  const RectificationTable straight = kernels::identity_table(8, 64);
  const cv::Mat3b drawing = decoded(encode_source_lines_png(straight, bent));
  EXPECT_EQ(drawing.size(), cv::Size(800, 500));
  // The vertical axis ends at 45, because 31 lines touch 43. The horizontal axis has 32 steps.
  const auto place = [](double lines, double y) {
    return cv::Point(cvRound(52 + lines / 32 * 724), cvRound(68 + 372 * (1 - y / 45)));
  };
  const cv::Vec3b blue(178, 114, 0);
  const cv::Vec3b vermilion(0, 94, 213);
  for (const int lines : {1, 15, 31}) {
    EXPECT_TRUE(is(drawing, place(lines, lines), blue));
    EXPECT_TRUE(is(drawing, place(lines, lines + 12), vermilion));
  }
}

TEST(TableDrawings, ShowTablesOfAnySizeAndWithoutValidEntries) {
  for (const auto& encode : {encode_displacement_png, encode_source_lines_png}) {
    for (const auto& table : {kernels::identity_table(4, 600), kernels::identity_table(4, 1),
                              RectificationTable{4, 40, std::vector<std::uint32_t>(160)}})
      EXPECT_NO_THROW(encode(table, table));
  }
}

}  // namespace
}  // namespace stereotlm::calib
