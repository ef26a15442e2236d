#include <fmt/format.h>

#include <opencv2/core.hpp>
#include <stdexcept>

#include "calib/calibration.h"
#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

void write(cv::FileStorage& file, const char* key, const RowError& error) {
  file << key << "{"
       << "mean_px" << error.mean_px << "max_px" << error.max_px << "corners"
       << static_cast<int>(error.corners) << "}";
}

void write(cv::FileStorage& file, const Quality& quality) {
  file << "quality"
       << "{";
  file << "reprojection_rms_px" << quality.stereo_rms_px;
  file << "left_reprojection_rms_px" << quality.left_rms_px;
  file << "right_reprojection_rms_px" << quality.right_rms_px;
  write(file, "row_error", quality.row_error);
  write(file, "row_error_found_again", quality.found_again);
  if (quality.held_out) {
    file << "held_out_reprojection_rms_px" << quality.held_out->rms_px;
    write(file, "held_out_row_error", quality.held_out->row_error);
  }
  file << "grid_disparity_min_px" << quality.disparities.min;
  file << "grid_disparity_max_px" << quality.disparities.max;
  file << "}";
}

void write(cv::FileStorage& file, const Certainty& its) {
  file << "certainty"
       << "{"
       << "alone_rms_px" << its.alone_rms_px << "rig_rms_px" << its.rig_rms_px << "has_fixed_intrinsics"
       << static_cast<int>(its.has_fixed_intrinsics) << "focal_sigma_px" << its.focal_sigma_px
       << "centre_sigma_px" << its.centre_sigma_px << "baseline_sigma_mm" << its.baseline_sigma_mm
       << "turn_sigma_deg" << its.turn_sigma_deg << "tilt_deg" << its.tilt_deg << "depth_errors"
       << "[";
  for (const DepthError& each : its.depths) {
    file << "{"
         << "depth_mm" << each.depth_mm << "rounding_mm" << each.rounding_mm << "calibration_mm"
         << each.calibration_mm << "}";
  }
  file << "]"
       << "}";
}

void write(cv::FileStorage& file, const std::vector<Source>& sources) {
  file << "sources"
       << "[";
  for (const Source& source : sources) {
    file << "{"
         << "left" << source.left << "right" << source.right << "corners_used"
         << static_cast<int>(source.corners_used) << "}";
  }
  file << "]";
}

}  // namespace

std::string calibration_yaml(const Calibration& calibration) {
  cv::FileStorage file(".yaml",
                       cv::FileStorage::WRITE | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
  const Rig& rig = calibration.rig;
  const Rectification& rectification = calibration.rectification;
  file << "image_width" << rig.width << "image_height" << rig.height;
  file << "disparities" << calibration.disparities << "disparity_offset" << calibration.disparity_offset;
  file << "left_lut_sha256" << calibration.left_lut_sha256;
  file << "right_lut_sha256" << calibration.right_lut_sha256;
  if (rig.left.is_fisheye)
    file << "lens_model"
         << "fisheye";
  file << "M1" << to_mat(rig.left.matrix) << "D1" << coefficients_of(rig.left);
  file << "M2" << to_mat(rig.right.matrix) << "D2" << coefficients_of(rig.right);
  file << "R" << to_mat(rig.rotation) << "T" << to_mat(rig.translation);
  file << "R1" << to_mat(rectification.r1) << "R2" << to_mat(rectification.r2);
  file << "P1" << to_mat(rectification.p1) << "P2" << to_mat(rectification.p2) << "Q"
       << to_mat(rectification.q);
  if (!calibration.imported.empty()) {
    file << "imported" << calibration.imported;
    return file.releaseAndGetString();
  }
  file << "grid"
       << "{"
       << "columns" << calibration.grid.columns << "rows" << calibration.grid.rows << "square_mm"
       << calibration.grid.square_mm << "pattern"
       << kPatternNames[static_cast<std::size_t>(calibration.grid.pattern)] << "}";
  write(file, calibration.sources);
  write(file, calibration.quality);
  if (calibration.certainty) write(file, *calibration.certainty);
  std::string text = file.releaseAndGetString();
  if (text.size() > kMostCalibrationBytes) {
    throw std::runtime_error(
        fmt::format("a calibration of {} pairs = {} bytes: must be {} at most: fewer pairs, or shorter paths",
                    calibration.sources.size(), text.size(), kMostCalibrationBytes));
  }
  return text;
}

}  // namespace stereotlm::calib
