#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/rig.h"

namespace stereotlm::calib {

// [corner]: distance in pixels from a corner found in a pair to the position at which a rig would see it.
struct Misfit {
  std::vector<double> left;
  std::vector<double> right;

  double of_corner(std::size_t corner) const { return std::max(left[corner], right[corner]); }
};

// A corner that was left out because it does not fit.
struct LeftOutCorner {
  std::size_t pair = 0;
  std::size_t corner = 0;
  double misfit_px = 0;
};

// The rig that explains the observed corners best (least squares).
struct RigFit {
  Rig rig;
  std::vector<std::vector<bool>> used;  // [pair][corner]
  std::vector<LeftOutCorner> left_out;  // the unused corners
  std::vector<Misfit> misfits;          // of all corners
  // Reprojection errors of the used corners: root of the mean square of their distances, in pixels.
  double left_rms_px = 0;
  double right_rms_px = 0;
  double stereo_rms_px = 0;  // over the pictures of both cameras
};

// Whether all five coefficients of the lens are fitted, or k3 stays 0.
enum class Lens : std::uint8_t { kFull, kWithoutK3 };

inline constexpr std::size_t kFewestPairs = 3;

// Calibrates both cameras and their relative pose (OpenCV's calibrateCamera and stereoCalibrate). The first
// fit uses the pairs that agree about the position of the right camera relative to the left. A corner is left
// out on both sides if its misfit is above max(8 * median, 0.1 pixels). A pair that keeps less than half of
// its corners is left out. The fit is repeated until it uses the same corners again. Throws
// std::invalid_argument if fewer than kFewestPairs are given or left; std::runtime_error if OpenCV finds no
// rig.
RigFit fit_rig(const GridShape& shape, int width, int height, const std::vector<GridPair>& pairs,
               Lens lens = Lens::kFull);

// One fit to the used corners, starting at the cameras of `guess`. Throws std::runtime_error if OpenCV finds
// no rig.
Rig solve_rig(const GridShape& shape, const std::vector<GridPair>& pairs,
              const std::vector<std::vector<bool>>& used, const Rig& guess, Lens lens);

// The misfit of all corners of a pair. The grid is placed where the used corners fit best.
Misfit misfit(const Rig& rig, const GridShape& shape, const GridPair& pair, const std::vector<bool>& used);

}  // namespace stereotlm::calib
