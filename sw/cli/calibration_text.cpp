#include "sw/cli/calibration_text.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <vector>

#include "calib/depth.h"
#include "calib/tables.h"
#include "sw/files/text_forms.h"

namespace stereotlm::cli {

std::string calibration_row(const std::string& name, const std::string& text) {
  return fmt::format("{:<16} {}\n", name, text);
}

namespace {

std::string rows_text(const calib::RowError& error) {
  return fmt::format("mean {:.3f} px, max {:.3f}, {} corners", error.mean_px, error.max_px, error.corners);
}

std::string camera_text(const calib::CameraModel& camera) {
  std::vector<double> lens(camera.distortion.begin(),
                           camera.distortion.begin() + static_cast<std::ptrdiff_t>(camera.coefficients()));
  for (double& each : lens) each = files::without_minus_zero(each, 4);
  return fmt::format("focal length {:.1f}, {:.1f} px, centre ({:.1f}, {:.1f}), {} {:.4f}",
                     camera.matrix(0, 0), camera.matrix(1, 1), camera.matrix(0, 2), camera.matrix(1, 2),
                     camera.is_fisheye ? "fisheye" : "distortion", fmt::join(lens, " "));
}

std::string depths_text(const calib::Calibration& made) {
  const auto depth = [&made](int disparity) {
    const auto found = calib::depth_in_the_middle(made, disparity);
    return found ? fmt::format("{:.0f} mm", *found) : "infinity";
  };
  return depth(made.disparities - 1) + " .. " + depth(0);
}

std::string offset_text(const calib::Calibration& made) {
  const int first = made.disparity_offset;
  return fmt::format("offset {}: 0 .. {} of the board are {} .. {}, {}", first, made.disparities - 1, first,
                     first + made.disparities - 1, depths_text(made));
}

std::string disparities_text(const calib::Calibration& made) {
  const calib::DisparityRange& grid = made.quality.disparities;
  const int first = made.disparity_offset;
  const int last = first + made.disparities - 1;
  return fmt::format("{:.1f} .. {:.1f} of the grid; {}{}", grid.min, grid.max, offset_text(made),
                     grid.min < first || grid.max > last ? " (the grid's do not fit)" : "");
}

std::string quality_text(const calib::Quality& quality) {
  std::string text = calibration_row(
      "reprojection", fmt::format("RMS {:.3f} px (left {:.3f}, right {:.3f})", quality.stereo_rms_px,
                                  quality.left_rms_px, quality.right_rms_px));
  text += calibration_row("row error", rows_text(quality.row_error));
  text +=
      calibration_row("found again", quality.found_again.corners == 0
                                         ? "nothing"
                                         : rows_text(quality.found_again) + ", in the rectified pictures");
  if (!quality.held_out) return text;
  return text +
         calibration_row("held out",
                         fmt::format("reprojection RMS {:.3f} px; row error {}; each pair by the others",
                                     quality.held_out->rms_px, rows_text(quality.held_out->row_error)));
}

std::string certainty_text(const calib::Certainty& its) {
  std::string text = calibration_row(
      "one sigma",
      fmt::format("+-{:.2f} px of the focal lengths, {:.2f} px of the centres, {:.3f} mm of the "
                  "baseline, {:.3f} degrees of the turn; the grid is tilted by up to {:.0f} degrees",
                  its.focal_sigma_px, its.centre_sigma_px, its.baseline_sigma_mm, its.turn_sigma_deg,
                  its.tilt_deg));
  if (its.has_fixed_intrinsics)
    text += calibration_row("intrinsics", "those of each camera alone: a joint fit would bend the lenses");
  for (const calib::DepthError& each : its.depths) {
    text +=
        calibration_row(&each == its.depths.data() ? "depths" : "",
                        fmt::format("at {:.0f} mm: +-{:.2g} mm of whole-pixel disparities, {:.2g} mm of the "
                                    "calibration, one sigma each",
                                    each.depth_mm, each.rounding_mm, each.calibration_mm));
  }
  return text;
}

}  // namespace

std::string calibration_text(const calib::Calibration& made) {
  const Eigen::AngleAxisd turn(made.rig.rotation);
  std::string text = calibration_row("left camera", camera_text(made.rig.left));
  text += calibration_row("right camera", camera_text(made.rig.right));
  text +=
      calibration_row("baseline", fmt::format("{:.2f} mm; turned by {:.2f} degrees against each other",
                                              made.rig.translation.norm(), calib::kDegrees * turn.angle()));
  if (made.certainty) text += certainty_text(*made.certainty);
  const bool has_grid = made.imported.empty();
  if (has_grid) text += quality_text(made.quality);
  text += calibration_row("rectified", fmt::format("focal length {:.1f} px", made.rectification.p1(0, 0)));
  return text + calibration_row("disparities", has_grid ? disparities_text(made) : offset_text(made));
}

std::string entries_text(const kernels::RectificationTable& table) {
  return fmt::format("{} of {} entries without source", calib::entries_without_source(table),
                     table.entries.size());
}

}  // namespace stereotlm::cli
