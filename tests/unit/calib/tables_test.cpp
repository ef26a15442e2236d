#include "calib/tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <stdexcept>

#include "calib/opencv_conversions.h"
#include "calib/synthetic_rig.h"

namespace stereotlm::calib {
namespace {

// The map of one side as OpenCV computes it, in single precision.
struct Map {
  cv::Mat columns;
  cv::Mat rows;
};

Map map_of(const Rig& rig, const CameraModel& camera, const Eigen::Matrix3d& rotation,
           const Projection& projection) {
  Map map;
  cv::initUndistortRectifyMap(to_mat(camera.matrix), to_mat(camera.distortion), to_mat(rotation),
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
  Rig rig_ = SyntheticRig(3, 320, 240).rig();
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

TEST_F(TablesTest, RefusePicturesOfMoreThan2048Rows) {
  rig_.height = 2049;
  EXPECT_THROW(tables(rig_, rectification_, 0), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::calib
