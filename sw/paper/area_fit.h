#pragma once

#include <vector>

#include "models/area/device.h"
#include "models/fpga/core_config.h"

namespace stereotlm::paper {

// A core with its published share of the slices of an FPGA.
struct PrintedArea {
  fpga::CoreConfig core;
  double slices_percent = 0;
};

// The rows of Table 2 of the paper: images of 640x480 and windows of 7x7 (its caption), for the circuit of
// figure 5, with look-up tables and LoG filters for both sides. The coefficients of the filter and the depths
// of the queues, which the paper does not state, are those of the preset `fpl2003`.
std::vector<PrintedArea> table_2();

// The result of fit_area(): the constant that area::total() should use for the least squared error over the
// printed rows, and the share of slices that the model then gives for each row.
struct AreaFit {
  double slices_per_lut_equivalent = 0;
  std::vector<double> slices_percent;
};

// Throws std::invalid_argument if there are no rows, or if a core has problems.
AreaFit fit_area(const std::vector<PrintedArea>& rows, const area::Device& device);

}  // namespace stereotlm::paper
