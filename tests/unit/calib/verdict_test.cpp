#include "calib/verdict.h"

#include <gtest/gtest.h>

#include <string>

namespace stereotlm::calib {
namespace {

// Of a rig with focal lengths of 500 and 520 px and a baseline of 100 mm, whose cameras fit to 0.1 px.
std::string verdict_with(double rig_rms_px, double focal_sigma_px, double baseline_sigma_mm, double tilt_deg,
                         std::size_t corners_of_last, std::size_t found_again = 1) {
  Calibration made;
  made.quality.found_again.corners = found_again;
  made.rig.left.matrix(0, 0) = 500;
  made.rig.right.matrix(0, 0) = 520;
  made.rig.translation = {-60, 80, 0};
  made.certainty = Certainty{0.1, rig_rms_px, false, focal_sigma_px, 0, baseline_sigma_mm, 0, tilt_deg, {}};
  made.sources = {{"", "", 54}, {"", "", corners_of_last}};
  return verdict_of(made);
}

TEST(Verdict, NamesEachWeaknessFromItsThresholdOn) {
  const std::string misfit =
      "the rig fits 1.5 times worse than each camera alone (0.15 and 0.10 px): take the "
      "two pictures of a pair at the same time, with cameras that are fixed";
  const std::string unsure =
      "one sigma of the focal length is 1 %, of the baseline 1 %, and the grid is tilted by "
      "10 degrees at most: add pairs with the grid tilted by 20 to 40 degrees, near and far";
  const std::string left_out = "1 of 2 pairs do not fit, and are left out: look at their pictures";
  EXPECT_EQ(verdict_with(0.1499, 4.99, 0.999, 10, 1),
            "good: each camera alone fits to 0.10 px, the rig to 0.15 px; one sigma of the focal length is 1 "
            "%, of the "
            "baseline 1 %");
  EXPECT_EQ(verdict_with(0.1501, 4.99, 0.999, 10, 1), "usable: " + misfit);
  EXPECT_EQ(verdict_with(0.1499, 5.01, 0.999, 10, 1), "usable: " + unsure);
  EXPECT_EQ(verdict_with(0.1499, 4.99, 1.001, 10, 1), "usable: " + unsure);
  EXPECT_EQ(verdict_with(0.1499, 4.99, 0.999, 9.99, 1), "usable: " + unsure);
  EXPECT_EQ(verdict_with(0.1499, 4.99, 0.999, 10, 0), "usable: " + left_out);
  EXPECT_EQ(verdict_with(0.1501, 5.01, 0.999, 10, 0), "usable: " + misfit + "; " + unsure + "; " + left_out);
  EXPECT_EQ(
      verdict_with(0.1499, 4.99, 0.999, 10, 1, 0),
      "usable: no grid lies whole in both rectified pictures, so that their rows were not compared: add "
      "pairs with the grid in the middle");
  EXPECT_EQ(verdict_of({}), "unknown: no pictures tell how certain it is");
}

}  // namespace
}  // namespace stereotlm::calib
