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

// The functions of this file do the arithmetic of contract sections 1 and 7.6 on single pairs of whole
// images, without memories and time. StereoPipeline does the same for many frames. Disparity images hold
// kInvalidDisparity where there is no disparity.

// The parameters of that arithmetic.
struct StereoConfig {
  int window = 7;        // n: kWindowRule
  int disparities = 80;  // D: kDisparitiesRule
  std::optional<FilterKernel> filter = log7();
  std::optional<int> lr_tolerance = 0;  // kLrToleranceRule; nullopt: no check
  MatchingCost cost{};
};

// Every broken rule as `field = value: rule`.
std::vector<std::string> problems(const StereoConfig& config);

// Returns the filtered image (F of contract 1.2). Throws std::invalid_argument if the kernel has problems or
// the image is empty.
GrayImage filter_image(const GrayImage& image, const FilterKernel& kernel);

struct Matches {
  GrayImage right_based;  // dR
  GrayImage left_based;   // dL
};
// Matches two filtered images (contract 1.3, 7.6). Throws std::invalid_argument if they differ in size, or
// the window, the number of disparities or the cost breaks its rule.
Matches match(const GrayImage& left, const GrayImage& right, int window, int disparities,
              const MatchingCost& cost = {});

// Rectifies, filters, matches and checks. A null table means that its side has none. Throws
// std::invalid_argument if the images or tables differ in size, if the images are empty but are to be
// filtered, or if the configuration or a table has problems.
GrayImage disparity_image(const GrayImage& left, const GrayImage& right, const RectificationTable* left_table,
                          const RectificationTable* right_table, const StereoConfig& config);

}  // namespace stereotlm::kernels
