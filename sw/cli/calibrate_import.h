#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/import_rig.h"

namespace stereotlm::cli {

// `calibrate --import`: a calibration that exists becomes tables, or a file of another format.
struct Import {
  std::vector<std::string> files;
  calib::ImportOptions options;
  int disparities = 80;           // candidates of the board
  std::optional<int> offset;      // of the left table
  std::optional<double> near_mm;  // depths that the disparities should cover
  std::optional<double> far_mm;
  std::string out;     // the calibration F.yaml
  std::string format;  // of --export; empty: our own, with tables
};

// Imports, writes and prints. Returns the exit status. Throws Refused.
int import_calibration(const Import& import);

}  // namespace stereotlm::cli
