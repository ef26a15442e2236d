#include "calib/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace stereotlm::calib {

std::string verdict_of(const Calibration& calibration) {
  constexpr double kMostRatio = 1.5;
  constexpr double kMostSigma = 1;   // percent
  constexpr double kLeastTilt = 10;  // degrees
  if (!calibration.certainty) return "unknown: no pictures tell how certain it is";
  const Certainty& its = *calibration.certainty;
  const double focal = 100 * its.focal_sigma_px /
                       std::min(calibration.rig.left.matrix(0, 0), calibration.rig.right.matrix(0, 0));
  const double baseline = 100 * its.baseline_sigma_mm / calibration.rig.translation.norm();
  const double ratio = its.rig_rms_px / its.alone_rms_px;
  std::vector<std::string> weak;
  if (ratio >= kMostRatio) {
    weak.push_back(
        fmt::format("the rig fits {:.1f} times worse than each camera alone ({:.2f} and {:.2f} px): "
                    "take the two pictures of a pair at the same time, with cameras that are fixed",
                    ratio, its.rig_rms_px, its.alone_rms_px));
  }
  if (focal > kMostSigma || baseline > kMostSigma || its.tilt_deg < kLeastTilt) {
    weak.push_back(
        fmt::format("one sigma of the focal length is {:.2g} %, of the baseline {:.2g} %, and the "
                    "grid is tilted by {:.0f} degrees at most: add pairs with the grid tilted by 20 "
                    "to 40 degrees, near and far",
                    focal, baseline, its.tilt_deg));
  }
  const auto left_out = std::count_if(calibration.sources.begin(), calibration.sources.end(),
                                      [](const Source& source) { return source.corners_used == 0; });
  if (left_out > 0) {
    weak.push_back(fmt::format("{} of {} pairs do not fit, and are left out: look at their pictures",
                               left_out, calibration.sources.size()));
  }
  if (calibration.quality.found_again.corners == 0) {
    weak.push_back(
        "no grid lies whole in both rectified pictures, so that their rows were not compared: add pairs with "
        "the "
        "grid in the middle");
  }
  if (!weak.empty()) return fmt::format("usable: {}", fmt::join(weak, "; "));
  return fmt::format(
      "good: each camera alone fits to {:.2f} px, the rig to {:.2f} px; one sigma of the focal length "
      "is {:.2g} %, of the baseline {:.2g} %",
      its.alone_rms_px, its.rig_rms_px, focal, baseline);
}

}  // namespace stereotlm::calib
