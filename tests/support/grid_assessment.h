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

// What the disparities of a board say about a grid that it has seen, measured by the grid itself. A corner of
// the left picture has the geometric disparity that follows from where both cameras see it.
struct GridAssessment {
  std::size_t corners = 0;
  std::size_t right = 0;       // the board's disparity there is within kMostDifference of the geometric one
  std::size_t wrong = 0;       // it is not
  std::size_t unanswered = 0;  // there is none, or the corner is outside the output
  // Distances between neighbouring corners, against the side of a square: by the board's disparities, of
  // corners that are right, and of all that are answered; and by the geometric disparities of the same
  // corners rounded to whole pixels, below which no board can come.
  Deviations lengths;
  Deviations lengths_of_answered;
  Deviations lengths_floor;
  // Of corners that are right: mean distance from the camera, and how far they lie from one plane: root of
  // the mean square, in percent of that distance. 0 with fewer than four.
  double distance_mm = 0;
  double plane_percent = 0;
  double plane_floor_percent = 0;
};

inline constexpr double kMostDifference = 1.5;  // pixels

// `disparity`: the board's output for this pair, with the tables of the calibration. Throws
// std::invalid_argument if its size is not that of the calibration's pictures.
GridAssessment assess(const calib::Calibration& calibration, const calib::GridPair& corners,
                      const kernels::GrayImage& disparity);

}  // namespace stereotlm::test
