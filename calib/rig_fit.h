#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/grid_shape.h"
#include "calib/rig.h"

namespace stereotlm::calib {

// What both cameras see of one position of the grid.
struct GridPair {
  Corners left;
  Corners right;
};

// Distances between where the corners of a pair are and where a rig would see them, pixels.
struct Misfit {
  std::vector<double> left;
  std::vector<double> right;

  double of_corner(std::size_t corner) const { return std::max(left[corner], right[corner]); }
};

// A corner that does not fit.
struct LeftOutCorner {
  std::size_t pair = 0;
  std::size_t corner = 0;
  double misfit_px = 0;
};

// The rig that explains best, in the sense of least squares, what was seen.
struct RigFit {
  Rig rig;
  std::vector<std::vector<bool>> used;  // by pair and corner
  std::vector<LeftOutCorner> left_out;  // the others
  std::vector<Misfit> misfits;          // of all corners
  // Reprojection errors of the corners used: root of the mean square of their distances, pixels.
  double left_rms_px = 0;
  double right_rms_px = 0;
  double stereo_rms_px = 0;  // over the pictures of both
};

// Whether the last coefficient of the lens is determined too, or is 0.
enum class Lens : std::uint8_t { kFull, kWithoutK3 };

inline constexpr std::size_t kFewestPairs = 3;

// Calibrates both cameras and their relative pose (OpenCV's calibrateCamera and stereoCalibrate), to begin
// with from the pairs that agree where the right camera is. A corner whose misfit is more than eight times
// the median, and than 0.1 pixels, is left out on both sides, and the fit repeated without those until none
// changes; a pair that keeps less than half of its corners is left out whole. Throws std::invalid_argument if
// there are fewer than kFewestPairs, or fewer are left; std::runtime_error if OpenCV finds no rig.
RigFit fit_rig(const GridShape& shape, int width, int height, const std::vector<GridPair>& pairs,
               Lens lens = Lens::kFull);

// One fit, to the corners used, from the cameras of `guess`. Throws std::runtime_error if OpenCV finds no
// rig.
Rig solve_rig(const GridShape& shape, const std::vector<GridPair>& pairs,
              const std::vector<std::vector<bool>>& used, const Rig& guess, Lens lens);

// With the grid where the corners used fit best.
Misfit misfit(const Rig& rig, const GridShape& shape, const GridPair& pair, const std::vector<bool>& used);

}  // namespace stereotlm::calib
