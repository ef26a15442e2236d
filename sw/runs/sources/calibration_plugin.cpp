#include <opencv2/core/utility.hpp>

#include "calib/calibration.h"
#include "sw/runs/sources/calibration_library.h"

namespace {

using namespace stereotlm;

// Keeps OpenCV from printing an error that it also throws.
int say_nothing(int /*status*/, const char* /*function*/, const char* /*message*/, const char* /*file*/,
                int /*line*/, void* /*data*/) {
  return 0;
}

calib::CalibrationResult calibrate(const calib::CalibrationRequest& request) {
  cv::redirectError(say_nothing);
  return calib::calibrate(request);
}

calib::ImportedRig import_rig(const std::vector<calib::ForeignFile>& files,
                              const calib::ImportOptions& options) {
  cv::redirectError(say_nothing);
  return calib::import_rig(files, options);
}

std::optional<std::string> foreign_format(const calib::ForeignFile& file) {
  cv::redirectError(say_nothing);
  return calib::foreign_format(file);
}

}  // namespace

// The only symbol that calibration_library.h looks up.
extern "C" {
extern const stereotlm::runs::CalibrationFunctions stereotlm_calibration_functions;
const stereotlm::runs::CalibrationFunctions stereotlm_calibration_functions = {
    calibrate,  calib::calibration_yaml, calib::matched_rows, calib::drawings, calib::encode_depth_color_png,
    import_rig, foreign_format,          calib::export_rig,   calib::rectify};
}
