#pragma once

#include "calib/certainty.h"
#include "calib/picture_mistakes.h"
#include "calib/rig_fit.h"

namespace stereotlm::calib {

struct DeterminedRig {
  RigFit fit;
  RigCovariance covariance;
  Certainty certainty;  // without the depths
};

// Fits the rig, without k3 if the lenses would fold the picture over, and refuses it if it is not to be
// believed. Throws std::invalid_argument, "refused: ..", with what was measured, its cause and its cure: the
// rig fits worse than its cameras (Evidence), the grids are not tilted, the cameras are exchanged, one above
// the other, turned against each other or of two kinds, or the lenses are not determined up to the corners of
// their pictures. Throws std::runtime_error if OpenCV finds no rig.
DeterminedRig determine_rig(const GridViews& views);

}  // namespace stereotlm::calib
