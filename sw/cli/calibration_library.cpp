#include "sw/cli/calibration_library.h"

#include "sw/cli/plugin.h"

namespace stereotlm::cli {

const CalibrationFunctions& calibration_functions() {
  static const auto& functions = *static_cast<const CalibrationFunctions*>(
      plugin_symbol("libstereotlm_calibration.so", "stereotlm_calibration_functions", "calibrates cameras"));
  return functions;
}

}  // namespace stereotlm::cli
