#include "sw/runs/sources/calibration_library.h"

#include "sw/process/installation.h"

namespace stereotlm::runs {

const CalibrationFunctions& calibration_functions() {
  static const auto& functions = *static_cast<const CalibrationFunctions*>(process::plugin_symbol(
      "libstereotlm_calibration.so", "stereotlm_calibration_functions", "calibrates cameras"));
  return functions;
}

}  // namespace stereotlm::runs
