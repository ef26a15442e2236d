#include "calib/grid_in_view.h"

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"

namespace stereotlm::calib {
namespace {

TEST(DisparityOffset, CentresTheGridsDisparities) {
  const DisparityRange range = {100.14, 203.4};
  EXPECT_EQ(range.needed(), 105);
  EXPECT_EQ(disparity_offset_for(range, 105), 100);
  EXPECT_EQ(disparity_offset_for(range, 106), 100);
  EXPECT_EQ(disparity_offset_for(range, 107), 99);
  EXPECT_EQ(disparity_offset_for(range, 112), 97);
}

TEST(DisparityOffset, IsNotBelowZeroUnlessItMustBe) {
  EXPECT_EQ(disparity_offset_for({3.5, 20}, 80), 0);
  EXPECT_EQ(disparity_offset_for({-3.5, 20}, 80), -4);
}

TEST(DisparityOffset, NamesTheDisparitiesNeededIfTheyDoNotFit) {
  EXPECT_EQ(test::message_of([] {
              disparity_offset_for({100.14, 203.4}, 104);
            }),
            "--disparities = 104: must be 105 or more for the grid's own, 100..204; or --disparity-offset N, "
            "for a part of them");
}

TEST(RowErrors, AverageAbsoluteValues) {
  RowErrors errors;
  EXPECT_EQ(errors.result().corners, 0U);
  errors.add({3, 10}, {9, 10.5});
  errors.add({3, 10}, {9, 8.5});
  EXPECT_DOUBLE_EQ(errors.result().mean_px, 1);
  EXPECT_DOUBLE_EQ(errors.result().max_px, 1.5);
  EXPECT_EQ(errors.result().corners, 2U);
}

}  // namespace
}  // namespace stereotlm::calib
