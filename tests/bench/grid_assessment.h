#pragma once

#include <cstddef>
#include <vector>

#include "calib/calibration.h"
#include "calib/rig_fit.h"
#include "models/kernels/gray_image.h"

namespace stereotlm::test {

// Deviations from a known value, in percent of it.
struct Deviations {
  std::vector<double> percent;

  double mean() const;
  double mean_absolute() const;
};

// Compares the disparities of a board with a grid that it has seen. The geometric disparity of a corner
// follows from where both cameras see it.
struct GridAssessment {
  std::size_t corners = 0;
  std::size_t right = 0;       // the board's disparity is within kMostDifference of the geometric disparity
  std::size_t wrong = 0;       // the board has another disparity
  std::size_t unanswered = 0;  // the board has no disparity, or the corner is outside its output
  // Deviations of the distances between neighbouring corners from the side of a square: of right corners; of
  // all answered corners; of right corners with their geometric disparities rounded to whole pixels, which is
  // the least error that a board can have.
  Deviations lengths;
  Deviations lengths_of_answered;
  Deviations lengths_floor;
  // Of right corners: the mean distance from the camera, and, in percent of that, the root mean square of
  // their distances from one plane (floor: as above). 0 with fewer than four right corners.
  double distance_mm = 0;
  double plane_percent = 0;
  double plane_floor_percent = 0;
};

inline constexpr double kMostDifference = 1.5;  // pixels

// `disparity` is the board's output for this pair with the tables of the calibration. Throws
// std::invalid_argument if its size is not that of the calibration's pictures.
GridAssessment assess(const calib::Calibration& calibration, const calib::GridPair& corners,
                      const kernels::GrayImage& disparity);

}  // namespace stereotlm::test
