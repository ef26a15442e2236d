#include "calib/determine_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace stereotlm::calib {
namespace {

[[noreturn]] void refuse(const std::string& cause) { throw std::invalid_argument("refused: " + cause); }

// Names the pairs that fit worst.
std::string worst_pairs(const GridViews& views, const RigFit& fit) {
  constexpr std::size_t kMost = 3;
  std::vector<std::pair<double, std::size_t>> misfits;
  for (std::size_t i = 0; i < fit.misfits.size(); ++i) misfits.emplace_back(fit.misfits[i].rms_px(), i);
  std::sort(misfits.rbegin(), misfits.rend());
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, misfits.size()); ++i) {
    text +=
        fmt::format("{}{} {:.2f} px", i == 0 ? "" : ", ", views.names[misfits[i].second], misfits[i].first);
  }
  return text;
}

// The rig does not explain what its cameras see: says what was measured, and why if that is found.
[[noreturn]] void refuse_misfit(const GridViews& views, const RigFit& fit) {
  const Evidence& evidence = fit.evidence;
  const std::string alone = fmt::format("each camera alone fits to {:.2f} px", evidence.alone_rms_px);
  const std::string measured =
      evidence.disagreement_mm > 0
          ? fmt::format("{}, but the pairs disagree by {:.0f} mm where the right camera stands", alone,
                        evidence.disagreement_mm)
          : fmt::format("{}, the rig to {:.2f} px; worst {}", alone, evidence.rig_rms_px,
                        worst_pairs(views, fit));
  if (const auto mistake = find_picture_mistake(views, fit.rig)) {
    refuse(fmt::format("{}: {}; if that is undone, the rig fits to {:.2f} px: {}", mistake->cause, measured,
                       mistake->rig_rms_px, mistake->cure));
  }
  refuse(
      fmt::format("the two pictures of a pair do not show the grid at the same place: {}: take both pictures "
                  "of a pair at the same time, of a grid that stands still, with two cameras on one bar",
                  measured));
}

// What pictures without tilt cannot tell: their sigmas are small, and wrong.
void check_tilt(const Evidence& evidence) {
  constexpr double kLeast = 3;  // degrees
  if (evidence.tilt_deg >= kLeast) return;
  refuse(
      fmt::format("the grid is tilted by {:.1f} degrees at most, so that the focal lengths are not "
                  "determined: take pairs with the grid tilted by 20 to 40 degrees, near and far",
                  evidence.tilt_deg));
}

void check_focal_length(const Rig& rig, const Certainty& certainty) {
  constexpr double kMost = 0.1;
  const double focal = rig.left.matrix(0, 0);
  if (certainty.focal_sigma_px <= kMost * focal) return;
  refuse(
      fmt::format("the focal length is {:.0f} +- {:.0f} px: take more pairs, with the grid tilted by 20 to "
                  "40 degrees, near and far",
                  focal, certainty.focal_sigma_px));
}

// Whether the pictures determine the lens models. A model that does not map directions one to one in the
// whole picture folds it over, which no lens does.
bool lenses_are_determined(const Rig& rig) try {
  for (const CameraModel& lens : {rig.left, rig.right}) {
    for (const int row : {0, rig.height - 1}) {
      for (const int column : {0, rig.width - 1}) lens.direction({column, row});
    }
  }
  return true;
} catch (const std::domain_error&) {
  return false;
}

}  // namespace

DeterminedRig determine_rig(const GridViews& views) {
  DeterminedRig result;
  RigFit& fit = result.fit;
  for (const Lens lens : {Lens::kFull, Lens::kWithoutK3}) {
    fit = fit_rig(views.shape, views.width, views.height, views.pairs, lens);
    if (fit.evidence.refutes() || lenses_are_determined(fit.rig)) break;
  }
  check_tilt(fit.evidence);
  if (fit.evidence.refutes()) refuse_misfit(views, fit);
  if (const auto problem = problem_of(fit.rig)) refuse(*problem);
  if (!lenses_are_determined(fit.rig))
    refuse(
        "the lenses are not determined up to the corners of their pictures: the grid must be seen there too");
  result.covariance = covariance(fit, views.shape, views.pairs);
  result.certainty = certainty_of(fit, result.covariance);
  check_focal_length(fit.rig, result.certainty);
  return result;
}

}  // namespace stereotlm::calib
