// stereotlm-demo-pictures: makes the inputs and montages of ./demo.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/calibration.h"
#include "calib/depth.h"
#include "calib/tables.h"
#include "models/kernels/stereo.h"
#include "sw/demo/demo_pictures.h"
#include "sw/files/output_file.h"
#include "sw/files/whole_file.h"
#include "sw/media/encode.h"
#include "sw/media/load.h"
#include "sw/media/truth.h"

namespace stereotlm::demo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUsage =
    "usage: stereotlm-demo-pictures prepare SRC_DIR OUT_DIR\n"
    "         from aloeL.jpg, aloeR.jpg, aloeGT.png make left.png, right.png, truth.png (640x480, truth "
    "scale 2);\n"
    "         print the number of disparities that the truth needs\n"
    "       stereotlm-demo-pictures depth-montage OUT.png LEFT RIG.yaml RESULT\n"
    "         show a picture, its rectified one, and the disparities and depths of RESULT side by side\n"
    "       stereotlm-demo-pictures montage OUT.png LEFT DISPARITY DISPARITIES [TRUTH]\n"
    "         show the picture, the disparities (0..DISPARITIES-1, 255 = invalid) and the truth side by "
    "side\n";

void write_file(const fs::path& path, const std::vector<std::uint8_t>& bytes) {
  files::OutputFile file(path, {"picture", [](const fs::path& /*file*/) { return true; }});
  file.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  file.commit();
}

void prepare(const fs::path& source, const fs::path& out) {
  const auto left = media::load_gray((source / "aloeL.jpg").string()).image;
  const auto right = media::load_gray((source / "aloeR.jpg").string()).image;
  const auto truth = media::load_truth((source / "aloeGT.png").string(), 1).grey;
  const auto pair = make_demo_pair(left, right, truth);
  fs::create_directories(out);
  write_file(out / "left.png", media::encode_png_gray(pair.left));
  write_file(out / "right.png", media::encode_png_gray(pair.right));
  write_file(out / "truth.png", media::encode_png_gray(pair.truth));
  std::printf("%.0f\n", media::disparities_needed({pair.truth, kTruthScale}));
}

Panel disparity_panel(const std::string& caption, const kernels::GrayImage& image, int disparities,
                      const std::string& missing) {
  return {caption, image, disparities, "0", std::to_string(disparities - 1), missing};
}

void montage(const std::vector<std::string>& arguments) {
  const int disparities = kernels::kDisparitiesRule.required("DISPARITIES", std::stoi(arguments[3]));
  std::vector<Panel> panels = {
      {"left picture", media::load_gray(arguments[1]).image, 0, "", "", ""},
      disparity_panel("disparity, pixels", media::load_gray(arguments[2]).image, disparities, "no answer")};
  if (arguments.size() == 5) {
    const auto truth = media::load_truth(arguments[4], kTruthScale);
    panels.push_back(disparity_panel("ground truth, pixels", media::nearest_disparity(truth, disparities),
                                     disparities, "unknown"));
  }
  write_file(arguments[0], encode_side_by_side_png(panels));
}

Panel depth_panel(const std::vector<std::uint16_t>& millimetres, int width, int height) {
  constexpr int kLevels = 254;
  Panel panel = {"depth", kernels::GrayImage(width, height, 255), kLevels, "far", "near", "no answer"};
  const auto range = calib::depth_range(millimetres);
  if (!range) return panel;
  const auto [near, far] = *range;
  for (std::size_t i = 0; i < millimetres.size(); ++i) {
    if (millimetres[i] == 0) continue;
    const int depth = std::clamp<int>(millimetres[i], near, far);
    panel.image.pixels[i] = static_cast<std::uint8_t>((kLevels - 1) * (far - depth) / (far - near));
  }
  panel.first = fmt::format("{} mm", far);
  panel.last = fmt::format("{} mm", near);
  return panel;
}

void depth_montage(const std::vector<std::string>& arguments) {
  const auto picture = media::load_gray(arguments[1]).image;
  const fs::path rig = arguments[2];
  const calib::Calibration calibration = calib::parse_calibration(files::read_whole_file(rig));
  const fs::path lut = rig.parent_path() / (rig.stem().string() + "_left.lut");
  const auto table = calib::parse_lut(files::read_whole_file(lut), picture.width, picture.height);
  const auto disparity = media::load_gray((fs::path(arguments[3]) / "disparity.png").string()).image;
  const calib::DepthGeometry geometry = {calibration.rectification.q, calibration.disparity_offset};
  const auto depths = calib::depth_millimetres(geometry, disparity);
  write_file(arguments[0],
             encode_side_by_side_png(
                 {{"left picture", picture, 0, "", "", ""},
                  {"rectified by the left table", kernels::rectify(picture, table), 0, "", "", ""},
                  disparity_panel("disparity, pixels", disparity, calibration.disparities, "no answer"),
                  depth_panel(depths, disparity.width, disparity.height)}));
}

int run(const std::vector<std::string>& arguments) {
  const std::string command = arguments.empty() ? "" : arguments[0];
  const std::vector<std::string> rest(arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end());
  if (command == "prepare" && rest.size() == 2) {
    prepare(rest[0], rest[1]);
  } else if (command == "depth-montage" && rest.size() == 4) {
    depth_montage(rest);
  } else if (command == "montage" && (rest.size() == 4 || rest.size() == 5)) {
    montage(rest);
  } else {
    std::fputs(kUsage, stderr);
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace stereotlm::demo

int main(int argc, char** argv) {
  try {
    return stereotlm::demo::run({argv + 1, argv + argc});
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "stereotlm-demo-pictures: %s\n", exception.what());
    return 1;
  }
}
