#include "calib/matched_rows.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "calib/synthetic_rig.h"
#include "calib/tables.h"

namespace stereotlm::calib {
namespace {

class MatchedRowsTest : public testing::Test {
 protected:
  static constexpr int kDisparities = 60;

  RowError matched(const Rig& assumed) const {
    const TablePair both = tables(assumed, rectify(assumed), 0);
    return matched_rows(kernels::rectify(scene_.left, both.left), kernels::rectify(scene_.right, both.right),
                        kDisparities)
        .error;
  }

  SyntheticRig rig_{4, 320, 240};
  SyntheticRig::Pair scene_ = rig_.scene();
};

TEST_F(MatchedRowsTest, AgreeToAFractionOfAPixelWithTheRigItself) {
  const RowError found = matched(rig_.rig());
  EXPECT_GT(found.corners, 20U);
  EXPECT_LT(found.mean_px, 0.4);  // the tables round by up to half a pixel on either side
}

TEST_F(MatchedRowsTest, DifferWithTheTablesOfAnotherRig) {
  Rig other = rig_.rig();
  other.right.matrix(1, 2) += 4;  // looks 4 pixels lower
  const RowError found = matched(other);
  EXPECT_GT(found.corners, 20U);
  EXPECT_GT(found.mean_px, 3);
}

TEST_F(MatchedRowsTest, AreAbsentInPicturesWithoutTexture) {
  const kernels::GrayImage flat(320, 240, 90);
  const MatchedRows found = matched_rows(flat, flat, kDisparities);
  EXPECT_EQ(found.points, 0U);
  EXPECT_EQ(found.error.corners, 0U);
}

TEST_F(MatchedRowsTest, RefusePicturesOfDifferentSizes) {
  EXPECT_THROW(matched_rows(kernels::GrayImage(32, 32), kernels::GrayImage(32, 28), 8),
               std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::calib
