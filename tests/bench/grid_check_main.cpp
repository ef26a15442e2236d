// stereotlm-grid-check measures how right a board's disparities are at the corners of the grid with which its
// rig was calibrated, and how right the distances that follow from them are.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "calib/calibration.h"
#include "calib/grid.h"
#include "sw/files/whole_file.h"
#include "sw/media/load.h"
#include "tests/bench/grid_assessment.h"

namespace stereotlm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kUsage =
    "usage: stereotlm-grid-check RIG.yaml RESULT\n"
    "         RESULT: of a run with --calibration RIG.yaml, --save-frames and --source preloaded whose frame "
    "i shows the\n"
    "         i-th pair of the calibration's sources; a JSON object for each pair, and one for all "
    "together\n";

calib::Corners corners_in(const std::string& picture, const calib::GridShape& shape) {
  const calib::GridSearch found = calib::find_grid(media::load_gray(picture).image, shape);
  if (!found.corners) throw std::runtime_error(picture + ": " + found.problem);
  return *found.corners;
}

Json lengths(const test::Deviations& deviations) {
  return {{"count", deviations.percent.size()},
          {"mean_percent", deviations.mean()},
          {"mean_absolute_percent", deviations.mean_absolute()}};
}

Json to_json(const std::string& name, const test::GridAssessment& found) {
  return {{"pair", name},
          {"corners", found.corners},
          {"right", found.right},
          {"wrong", found.wrong},
          {"unanswered", found.unanswered},
          {"lengths", lengths(found.lengths)},
          {"lengths_of_answered", lengths(found.lengths_of_answered)},
          {"lengths_floor", lengths(found.lengths_floor)},
          {"distance_mm", found.distance_mm},
          {"plane_percent", found.plane_percent},
          {"plane_floor_percent", found.plane_floor_percent}};
}

void add(test::Deviations& all, const test::Deviations& more) {
  all.percent.insert(all.percent.end(), more.percent.begin(), more.percent.end());
}

void run(const std::string& rig, const std::filesystem::path& result) {
  const calib::Calibration calibration = calib::parse_calibration(files::read_whole_file(rig));
  test::GridAssessment all;
  Json pairs = Json::array();
  for (std::size_t i = 0; i < calibration.sources.size(); ++i) {
    const calib::Source& source = calibration.sources[i];
    calib::GridPair corners = {corners_in(source.left, calibration.grid),
                               corners_in(source.right, calibration.grid)};
    corners.right = calib::ordered_like(corners.left, calibration.grid, corners.right);
    const auto disparity = media::load_gray((result / fmt::format("frames/{:06}.png", i)).string()).image;
    const test::GridAssessment found = test::assess(calibration, corners, disparity);
    pairs.push_back(to_json(std::filesystem::path(source.left).filename(), found));
    all.corners += found.corners;
    all.right += found.right;
    all.wrong += found.wrong;
    all.unanswered += found.unanswered;
    add(all.lengths, found.lengths);
    add(all.lengths_of_answered, found.lengths_of_answered);
    add(all.lengths_floor, found.lengths_floor);
    all.distance_mm += found.distance_mm / static_cast<double>(calibration.sources.size());
    all.plane_percent += found.plane_percent / static_cast<double>(calibration.sources.size());
    all.plane_floor_percent += found.plane_floor_percent / static_cast<double>(calibration.sources.size());
  }
  std::puts(Json{{"pairs", pairs}, {"all", to_json("all", all)}}.dump(1).c_str());
}

}  // namespace
}  // namespace stereotlm::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs(stereotlm::bench::kUsage, stderr);
    return 2;
  }
  try {
    stereotlm::bench::run(argv[1], argv[2]);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "stereotlm-grid-check: %s\n", exception.what());
    return 1;
  }
}
