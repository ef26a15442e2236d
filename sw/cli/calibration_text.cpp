#include "sw/cli/calibration_text.h"

#include <fmt/format.h>

#include <vector>

#include "calib/depth.h"
#include "calib/tables.h"
#include "sw/files/text_forms.h"

namespace stereotlm::cli {

std::string calibration_row(const std::string& name, const std::string& text) {
  return fmt::format("{:<16} {}\n", name, text);
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

std::string entries_text(const kernels::RectificationTable& table) {
  return fmt::format("{} of {} entries without source", calib::entries_without_source(table),
                     table.entries.size());
}

}  // namespace stereotlm::cli
