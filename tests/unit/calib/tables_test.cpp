#include "calib/tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <random>
#include <stdexcept>

#include "calib/opencv_conversions.h"
#include "sw/media/synthetic_rig.h"

namespace stereotlm::calib {
namespace {

using kernels::make_entry;
using kernels::RectificationTable;

// The map of one side as OpenCV computes it, in single precision.
struct Map {
  cv::Mat columns;
  cv::Mat rows;
};

Map map_of(const Rig& rig, const CameraModel& camera, const Eigen::Matrix3d& rotation,
           const Projection& projection) {
  Map map;
  cv::initUndistortRectifyMap(to_mat(camera.matrix), coefficients_of(camera), to_mat(rotation),
                              to_mat(projection), {rig.width, rig.height}, CV_32FC1, map.columns, map.rows);
  return map;
}

// Whole positions may differ where the source lies half way between two pixels in single precision.
void expect_like(const kernels::RectificationTable& table, const Map& map) {
  constexpr double kSingle = 1e-4;
  std::size_t invalid = 0;
  for (int row = 0; row < table.height; ++row) {
    for (int column = 0; column < table.width; ++column) {
      const std::uint32_t entry =
          table.entries[static_cast<std::size_t>(row) * static_cast<std::size_t>(table.width) +
                        static_cast<std::size_t>(column)];
      const double x = map.columns.at<float>(row, column);
      const double y = map.rows.at<float>(row, column);
      if (kernels::entry_is_valid(entry)) {
        ASSERT_NEAR(kernels::entry_column(entry), x, 0.5 + kSingle) << column << ' ' << row;
        ASSERT_NEAR(kernels::entry_row(entry), y, 0.5 + kSingle) << column << ' ' << row;
      } else {
        ++invalid;
        ASSERT_TRUE(x < -0.5 + kSingle || x > table.width - 0.5 - kSingle || y < -0.5 + kSingle ||
                    y > table.height - 0.5 - kSingle)
            << column << ' ' << row;
      }
    }
  }
  EXPECT_LT(invalid, table.entries.size());
}

class TablesTest : public testing::Test {
 protected:
  Rig rig_ = media::SyntheticRig(3, 320, 240).rig();
  Rectification rectification_ = rectify(rig_);
};

TEST_F(TablesTest, HoldThePixelNearestToOpenCVsMaps) {
  const TablePair found = tables(rig_, rectification_, 0);
  expect_like(found.left, map_of(rig_, rig_.left, rectification_.r1, rectification_.p1));
  expect_like(found.right, map_of(rig_, rig_.right, rectification_.r2, rectification_.p2));
}

TEST_F(TablesTest, HaveNoEntryOutsideThePicture) {
  rectification_.p1(0, 2) += 150;  // looks far to the side
  const TablePair found = tables(rig_, rectification_, 0);
  EXPECT_TRUE(kernels::problems(found.left).empty());
  expect_like(found.left, map_of(rig_, rig_.left, rectification_.r1, rectification_.p1));
  EXPECT_FALSE(kernels::entry_is_valid(found.left.entries.front()));
}

TEST_F(TablesTest, ShiftTheLeftColumnsByTheOffset) {
  const TablePair plain = tables(rig_, rectification_, 0);
  for (const int offset : {23, -23}) {
    const TablePair shifted = tables(rig_, rectification_, offset);
    EXPECT_EQ(shifted.right.entries, plain.right.entries);
    for (int row = 0; row < 240; ++row) {
      for (int column = 23; column < 320 - 23; ++column) {
        const std::size_t start = static_cast<std::size_t>(row) * 320;
        ASSERT_EQ(shifted.left.entries[start + static_cast<std::size_t>(column)],
                  plain.left.entries[start + static_cast<std::size_t>(column + offset)]);
      }
    }
  }
}

// Far to the side the polynomial of the lens bends directions back into the picture.
TEST_F(TablesTest, HaveNoEntryBeyondTheLens) {
  rig_.left.distortion = {-0.29, 0.14, 0, 0, -0.05};
  rectification_ = rectify(rig_);
  for (const int offset : {-600, -300, 300, 600, 1000}) {
    const TablePair found = tables(rig_, rectification_, offset);
    std::size_t valid = 0;
    for (int i = 0; i < 320 * 240; ++i) {
      const std::uint32_t entry = found.left.entries[static_cast<std::size_t>(i)];
      if (!kernels::entry_is_valid(entry)) continue;
      ++valid;
      const Eigen::Vector2d back = rectified_pixel(rig_.left, rectification_.r1, rectification_.p1,
                                                   {kernels::entry_column(entry), kernels::entry_row(entry)});
      ASSERT_LT((back - Eigen::Vector2d(i % 320 + offset, i / 320)).norm(), 3) << offset << ' ' << i;
    }
    EXPECT_EQ(valid == 0, std::abs(offset) >= 600) << offset << ' ' << valid;
  }
}

TEST_F(TablesTest, AreRecognisedByTheirRig) {
  const TablePair both = tables(rig_, rectification_, 12);
  EXPECT_TRUE(are_tables_of(both, rig_, rectification_, 12));
  EXPECT_FALSE(are_tables_of(both, rig_, rectification_, 11));
  Rig other = rig_;
  other.right.distortion[0] += 0.01;
  EXPECT_FALSE(are_tables_of(both, other, rectification_, 12));
}

TEST(LutFile, IsLittleEndianRowByRow) {
  kernels::RectificationTable table = {
      2, 3, {0, kernels::make_entry(1, 2), 0, 0, 0, kernels::make_entry(0, 1)}};
  const std::string bytes = lut_bytes(table);
  ASSERT_EQ(bytes.size(), 24U);
  EXPECT_EQ(bytes.substr(4, 4), std::string("\x01\x00\x02\x80", 4));
  const kernels::RectificationTable again = parse_lut(bytes, 2, 3);
  EXPECT_EQ(again.entries, table.entries);
  EXPECT_EQ(again.width, 2);
  EXPECT_EQ(again.height, 3);
}

TEST(LutFile, IsRefusedWithAnotherSizeOrABrokenEntry) {
  EXPECT_THROW(parse_lut(std::string(23, '\0'), 2, 3), std::runtime_error);
  EXPECT_THROW(parse_lut(std::string(28, '\0'), 2, 3), std::runtime_error);
  std::string bytes(24, '\0');
  bytes[3] = '\x40';  // a bit that is not used
  EXPECT_THROW(parse_lut(bytes, 2, 3), std::runtime_error);
  bytes[3] = '\x80';
  bytes[0] = '\x02';  // column 2 of 2
  EXPECT_THROW(parse_lut(bytes, 2, 3), std::runtime_error);
}

TEST(EntriesWithoutSource, AreCounted) {
  RectificationTable table = kernels::identity_table(8, 6);
  EXPECT_EQ(entries_without_source(table), 0U);
  table.entries[7] = table.entries[20] = 0;
  EXPECT_EQ(entries_without_source(table), 2U);
}

// The definition of the header, entry by entry.
int expected_lines(const RectificationTable& table, int lines) {
  int expected = 0;
  for (int top = 0; top + lines <= table.height; ++top) {
    std::vector<int> named;
    for (int i = top * table.width; i < (top + lines) * table.width; ++i) {
      const std::uint32_t entry = table.entries[static_cast<std::size_t>(i)];
      if (kernels::entry_is_valid(entry)) named.push_back(kernels::entry_row(entry));
    }
    const auto [first, last] = std::minmax_element(named.begin(), named.end());
    if (!named.empty()) expected = std::max(expected, *last - *first + 1);
  }
  return expected;
}

TEST(SourceLines, FollowTheirDefinitionForAnyTable) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> place(0, 11);
  RectificationTable table{12, 12, {}};
  for (int i = 0; i < 144; ++i) {
    table.entries.push_back(place(random) < 10 ? 0 : make_entry(place(random), place(random)));
  }
  for (int lines = 1; lines <= 12; ++lines)
    EXPECT_EQ(source_lines(table, lines), expected_lines(table, lines));
  EXPECT_EQ(source_lines(RectificationTable{2, 3, std::vector<std::uint32_t>(6)}, 2), 0);
}

TEST(SourceLines, RefuseAWindowOutsideThePictureOrABrokenTable) {
  RectificationTable table = kernels::identity_table(8, 6);
  EXPECT_THROW(source_lines(table, 0), std::invalid_argument);
  EXPECT_EQ(source_lines(table, 6), 6);
  EXPECT_THROW(source_lines(table, 7), std::invalid_argument);
  table.entries.pop_back();
  EXPECT_THROW(source_lines(table, 1), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::calib
