#pragma once

#include <vector>

#include "models/area/device.h"
#include "models/fpga/core_config.h"

namespace stereotlm::paper {

// A core whose share of the slices of an FPGA has been published.
struct PrintedArea {
  fpga::CoreConfig core;
  double slices_percent = 0;
};

// Table 2 of the paper. Its caption gives images of 640x480 and windows of 7x7; the circuit whose size it
// prints is that of figure 5, with calibration (look-up tables) and LoG filter for both sides. What the paper
// does not say, the coefficients of the filter and the depths of the queues, is as in the preset `fpl2003`.
std::vector<PrintedArea> table_2();

// The constant of area::total() that brings the model nearest to printed rows, by least squares of slices,
// and what the model then says of each row.
struct AreaFit {
  double slices_per_lut_equivalent = 0;
  std::vector<double> slices_percent;
};

// Throws std::invalid_argument without rows, and if a core has problems.
AreaFit fit_area(const std::vector<PrintedArea>& rows, const area::Device& device);

}  // namespace stereotlm::paper
