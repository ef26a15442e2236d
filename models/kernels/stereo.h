#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/kernels/filter_kernel.h"
#include "models/kernels/gray_image.h"
#include "models/kernels/limits.h"
#include "models/kernels/matching_cost.h"
#include "models/kernels/rectification_table.h"

namespace stereotlm::kernels {

// The parameters of the arithmetic of contract sections 1 and 7.6.
struct StereoConfig {
  int window = 7;                               // n: kWindowRule
  int disparities = 80;                         // D: kDisparitiesRule
  std::optional<FilterKernel> filter = log7();  // nullopt: no filter
  std::optional<int> lr_tolerance = 0;          // kLrToleranceRule; nullopt: no check
  MatchingCost cost{};                          // of two windows
};

// Every broken rule as `field = value: rule`.
std::vector<std::string> problems(const StereoConfig& config);

// Rectifies, filters, matches and checks a single pair of whole images, without memories and time;
// StereoPipeline does the same for many frames. The disparity is kInvalidDisparity where there is none. A
// null table means that its side has none. Throws std::invalid_argument if the images or tables differ in
// size, if the images are empty but are to be filtered, or if the configuration or a table has problems.
GrayImage disparity_image(const GrayImage& left, const GrayImage& right, const RectificationTable* left_table,
                          const RectificationTable* right_table, const StereoConfig& config);

}  // namespace stereotlm::kernels
