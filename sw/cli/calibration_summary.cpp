#include "sw/cli/calibration_summary.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "calib/depth.h"
#include "calib/tables.h"

namespace stereotlm::cli {
namespace {

using calib::Calibration;
using calib::RowError;

constexpr int kWindow = 7;  // window of fpl2003, pixels

std::string row(const std::string& name, const std::string& text) {
  return fmt::format("{:<16} {}\n", name, text);
}

std::string rows_text(const RowError& error) {
  return fmt::format("mean {:.3f} px, max {:.3f}, {} corners", error.mean_px, error.max_px, error.corners);
}

std::string camera_text(const calib::CameraModel& camera) {
  return fmt::format("focal length {:.1f}, {:.1f} px, centre ({:.1f}, {:.1f}), distortion {:.4f}",
                     camera.matrix(0, 0), camera.matrix(1, 1), camera.matrix(0, 2), camera.matrix(1, 2),
                     fmt::join(camera.distortion, " "));
}

std::string pairs_text(const calib::CalibrationResult& result, std::size_t pictures) {
  const auto& sources = result.calibration.sources;
  const std::size_t corners =
      std::accumulate(sources.begin(), sources.end(), std::size_t{0},
                      [](std::size_t sum, const calib::Source& source) { return sum + source.corners_used; });
  return fmt::format("{} of {} with the grid; of {} corners each, {} fit, {} do not", result.pairs.size(),
                     pictures, result.calibration.grid.corners(), corners, result.left_out.size());
}

// The nearest and the farthest depth that the disparities cover, at the centre of the picture.
std::string depths_text(const Calibration& made) {
  const calib::DepthGeometry geometry = {made.rectification.q, made.disparity_offset};
  const auto depth = [&](int disparity) {
    const auto point = geometry.point(made.rig.width / 2.0, made.rig.height / 2.0, disparity);
    return point ? fmt::format("{:.0f} mm", point->z()) : "infinity";
  };
  return depth(made.disparities - 1) + " .. " + depth(0);
}

std::string disparities_text(const Calibration& made) {
  const calib::DisparityRange& grid = made.quality.disparities;
  const int first = made.disparity_offset;
  const int last = first + made.disparities - 1;
  return fmt::format("{:.1f} .. {:.1f} of the grid; offset {}: 0 .. {} of the board are {} .. {}, {}{}",
                     grid.min, grid.max, first, made.disparities - 1, first, last, depths_text(made),
                     grid.min < first || grid.max > last ? " (the grid's do not fit)" : "");
}

std::string table_text(const kernels::RectificationTable& table) {
  const auto invalid = std::count_if(table.entries.begin(), table.entries.end(),
                                     [](std::uint32_t entry) { return !kernels::entry_is_valid(entry); });
  std::string text = fmt::format("{} of {} entries without source", invalid, table.entries.size());
  if (table.height >= kWindow) {
    const std::vector<int> lines = calib::source_lines(table, kWindow);
    text += fmt::format("; a window of {} lines touches up to {} of the picture", kWindow,
                        *std::max_element(lines.begin(), lines.end()));
  }
  return text;
}

std::string left_out_text(const calib::CalibrationResult& result) {
  constexpr std::size_t kMost = 10;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, result.left_out.size()); ++i) {
    const calib::LeftOutCorner& corner = result.left_out[i];
    const calib::Source& source = result.calibration.sources[corner.pair];
    const auto columns = static_cast<std::size_t>(result.calibration.grid.columns);
    text += row(i == 0 ? "left out" : "",
                fmt::format("corner ({}, {}) of '{}' and '{}': off by {:.2f} px", corner.corner % columns,
                            corner.corner / columns, source.left, source.right, corner.misfit_px));
  }
  if (result.left_out.size() > kMost)
    text += row("", fmt::format("and {} more", result.left_out.size() - kMost));
  return text;
}

}  // namespace

std::string calibration_summary(const calib::CalibrationResult& result, std::size_t pictures) {
  const Calibration& made = result.calibration;
  const calib::Quality& quality = made.quality;
  const Eigen::AngleAxisd turn(made.rig.rotation);
  constexpr double kDegrees = 57.29577951308232;
  std::string text = row("pairs", pairs_text(result, pictures));
  text += left_out_text(result);
  text += row("left camera", camera_text(made.rig.left));
  text += row("right camera", camera_text(made.rig.right));
  if (result.lens == calib::Lens::kWithoutK3) {
    text += row("lenses", "k3 is taken as 0: the grid was not seen far enough out to determine it");
  }
  text += row("baseline", fmt::format("{:.2f} mm; turned by {:.2f} degrees against each other",
                                      made.rig.translation.norm(), kDegrees * turn.angle()));
  text += row("reprojection", fmt::format("RMS {:.3f} px (left {:.3f}, right {:.3f})", quality.stereo_rms_px,
                                          quality.left_rms_px, quality.right_rms_px));
  text += row("row error", rows_text(quality.row_error));
  text += row("found again", rows_text(quality.found_again) + ", in the rectified pictures");
  if (quality.held_out) {
    text += row("held out", fmt::format("reprojection RMS {:.3f} px; row error {}; each pair by the others",
                                        quality.held_out->rms_px, rows_text(quality.held_out->row_error)));
  }
  text += row("rectified", fmt::format("focal length {:.1f} px", made.rectification.p1(0, 0)));
  text += row("disparities", disparities_text(made));
  text += row("left table", table_text(result.tables.left));
  text += row("right table", table_text(result.tables.right));
  return text;
}

}  // namespace stereotlm::cli
