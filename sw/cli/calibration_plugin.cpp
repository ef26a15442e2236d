#include "calib/calibration_yaml.h"
#include "sw/cli/calibration_library.h"
#include "sw/media/captured_stderr.h"

namespace {

using namespace stereotlm;

// OpenCV says on standard error what it then throws.
calib::Calibration parse_quietly(const std::string& text) {
  const media::CapturedStderr captured;
  return calib::parse_calibration(text);
}

calib::CalibrationResult calibrate_quietly(const calib::CalibrationRequest& request) {
  const media::CapturedStderr captured;
  return calib::calibrate(request);
}

}  // namespace

// The one symbol of the library that calibration_library.h loads.
extern "C" {
extern const stereotlm::cli::CalibrationFunctions stereotlm_calibration_functions;
const stereotlm::cli::CalibrationFunctions stereotlm_calibration_functions = {
    calibrate_quietly,
    calib::calibration_yaml,
    parse_quietly,
    calib::matched_rows,
    calib::encode_corners_png,
    calib::encode_rectified_pair_png,
    calib::encode_displacement_png,
    calib::encode_source_lines_png,
    calib::grid_sheet_pdf,
    calib::grid_sheet_svg};
}
