#include "calib/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace stereotlm::calib {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// At the good side of each threshold.
Calibration good() {
  Calibration made;
  made.rig.left.matrix(0, 0) = 500;
  made.rig.right.matrix(0, 0) = 520;
  made.rig.translation = {-60, 80, 0};
  made.certainty = Certainty();
  made.certainty->alone_rms_px = 0.1;
  made.certainty->rig_rms_px = 0.1499;
  made.certainty->focal_sigma_px = 4.99;
  made.certainty->baseline_sigma_mm = 0.999;
  made.certainty->tilt_deg = 10;
  made.sources = {{"l0", "r0", 54}, {"l1", "r1", 1}};
  return made;
}

std::string verdict_with(void (*change)(Calibration&)) {
  Calibration made = good();
  change(made);
  return verdict_of(made);
}

TEST(Verdict, IsGoodUpToTheThresholds) {
  EXPECT_EQ(verdict_of(good()),
            "good: the rig fits as well as its cameras (0.15 and 0.10 px), and one sigma of the focal length "
            "is 1 %, of the baseline 1 %");
}

TEST(Verdict, IsUsableWithEachWeaknessAndItsCure) {
  EXPECT_THAT(verdict_with([](Calibration& made) { made.certainty->rig_rms_px = 0.1501; }),
              StartsWith("usable: the rig fits 1.5 times worse than each camera alone (0.15 and 0.10 px): "
                         "take the two pictures of a pair at the same time"));
  EXPECT_THAT(verdict_with([](Calibration& made) { made.certainty->focal_sigma_px = 5.01; }),
              StartsWith("usable: one sigma of the focal length is 1 %, of the baseline 1 %, and the grid is "
                         "tilted by 10 degrees at most: add pairs with the grid tilted by 20 to 40 degrees"));
  EXPECT_THAT(verdict_with([](Calibration& made) { made.certainty->baseline_sigma_mm = 1.001; }),
              StartsWith("usable: one sigma of the focal length is 1 %, of the baseline 1 %"));
  EXPECT_THAT(verdict_with([](Calibration& made) { made.certainty->tilt_deg = 9.99; }),
              StartsWith("usable: one sigma of the focal length is 1 %, of the baseline 1 %"));
  EXPECT_EQ(verdict_with([](Calibration& made) { made.sources[1].corners_used = 0; }),
            "usable: 1 of 2 pairs do not fit, and are left out: look at their pictures");
}

TEST(Verdict, NamesAllWeaknesses) {
  EXPECT_THAT(
      verdict_with([](Calibration& made) {
        made.certainty->rig_rms_px = 1;
        made.certainty->tilt_deg = 5;
        made.sources[0].corners_used = 0;
      }),
      testing::AllOf(StartsWith("usable: the rig fits 10.0 times worse"),
                     HasSubstr("; one sigma of the focal length is 1 %"),
                     HasSubstr("tilted by 5 degrees at most"), HasSubstr("; 1 of 2 pairs do not fit")));
}

TEST(Verdict, IsUnknownWithoutPictures) {
  EXPECT_EQ(verdict_with([](Calibration& made) { made.certainty.reset(); }),
            "unknown: no pictures tell how certain it is");
}

}  // namespace
}  // namespace stereotlm::calib
