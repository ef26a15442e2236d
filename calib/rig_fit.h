#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/rig.h"

namespace stereotlm::calib {

// [corner]: distance in pixels from a corner found in a pair to the position at which a rig would see it.
struct Misfit {
  Eigen::Isometry3d pose;  // from the grid to camera coordinates of the left camera, where it fits best
  std::vector<double> left;
  std::vector<double> right;

  double of_corner(std::size_t corner) const { return std::max(left[corner], right[corner]); }
  double rms_px() const;
};

// A corner that was left out because it does not fit.
struct LeftOutCorner {
  std::size_t pair = 0;
  std::size_t corner = 0;
  double misfit_px = 0;
};

// Whether all five coefficients of the lens are fitted, or k3 stays 0.
enum class Lens : std::uint8_t { kFull, kWithoutK3 };

// How well each camera fits by itself, and how well both fit as a rig. They fit equally well if the two
// pictures of each pair show the grid at the same place.
struct Evidence {
  double alone_rms_px = 0;  // reprojection of the worse camera, which is fitted by itself
  double rig_rms_px = 0;    // of both cameras with the intrinsics of these fits
  double tilt_deg = 0;      // the largest angle between a grid and the picture of the left camera alone
  // Whether the rig has the intrinsics of these fits, because a joint fit would bend the lenses.
  bool has_fixed_intrinsics = false;
  bool has_few_pairs = false;  // whether fewer than kFewestPairs fit, so that no corner was left out

  // The median distance between the places of the right camera by each pair and by their median, mm, if it is
  // so large that no rig was fitted. Else 0.
  double disagreement_mm = 0;

  double ratio() const { return rig_rms_px / alone_rms_px; }
  // Whether the rig does not explain what its cameras see.
  bool refutes() const { return has_few_pairs || disagreement_mm > 0 || (ratio() >= 3 && rig_rms_px >= 0.2); }
};

// The rig that explains the observed corners best (least squares).
struct RigFit {
  Rig rig;
  Lens lens = Lens::kFull;
  Evidence evidence;
  std::vector<std::vector<bool>> used;  // [pair][corner]
  std::vector<LeftOutCorner> left_out;  // the unused corners
  std::vector<Misfit> misfits;          // of all corners
  // Reprojection errors of the used corners: root of the mean square of their distances, in pixels.
  double left_rms_px = 0;
  double right_rms_px = 0;
  double stereo_rms_px = 0;  // over the pictures of both cameras
};

inline constexpr std::size_t kFewestPairs = 3;

// Calibrates both cameras and their relative pose (OpenCV's calibrateCamera and stereoCalibrate). The first
// fit uses the pairs that agree about the position of the right camera relative to the left. A corner is left
// out on both sides if its misfit is above max(8 * median, 0.1 pixels). A pair is left out if it keeps less
// than half of its corners, or if the rig fits to it 1.8 times worse, compared with each camera alone, than
// to the median pair. The fit is repeated until it uses the same corners again. Then each camera is fitted by
// itself to these corners. The result has the intrinsics of these fits, if the rig fits 1.5 times worse than
// its cameras or more, and the joint fit moved a focal length or a centre by more than 3 sigma. If the pairs
// do not nearly agree where the cameras stand, or if one is turned by more than kMostRoll, no corner is
// fitted and the result has the intrinsics of single fits and no misfits. The caller looks at
// RigFit::evidence. Throws std::invalid_argument if fewer than kFewestPairs are given; std::runtime_error if
// OpenCV finds no rig.
RigFit fit_rig(const GridShape& shape, int width, int height, const std::vector<GridPair>& pairs,
               Lens lens = Lens::kFull);

// The rig with the intrinsics of single fits to all corners of all pairs, of which none is left out. The fits
// start at the cameras of `guess`. Nullopt if the pairs do not nearly agree where the cameras stand. Throws
// std::runtime_error if OpenCV finds no rig.
std::optional<RigFit> fit_all(const GridShape& shape, const std::vector<GridPair>& pairs, const Rig& guess);

// Whether a fit may change the focal lengths, centres and lenses at which it starts.
enum class Intrinsics : std::uint8_t { kFitted, kFixed };

// One fit to the used corners, starting at the cameras of `guess`. Throws std::runtime_error if OpenCV finds
// no rig.
Rig solve_rig(const GridShape& shape, const std::vector<GridPair>& pairs,
              const std::vector<std::vector<bool>>& used, const Rig& guess, Lens lens,
              Intrinsics intrinsics = Intrinsics::kFitted);

// The misfit of all corners of a pair. The grid is placed where the used corners fit best.
Misfit misfit(const Rig& rig, const GridShape& shape, const GridPair& pair, const std::vector<bool>& used);

}  // namespace stereotlm::calib
