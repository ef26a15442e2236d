// stereotlm-demo-pictures: makes the inputs and montages of ./demo.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calib/calibration.h"
#include "calib/canvas.h"
#include "calib/depth.h"
#include "calib/tables.h"
#include "models/kernels/lr_check.h"
#include "models/kernels/stereo.h"
#include "sw/demo/half_size.h"
#include "sw/files/output_file.h"
#include "sw/files/whole_file.h"
#include "sw/media/encode.h"
#include "sw/media/load.h"

namespace stereotlm::demo {
namespace {

namespace fs = std::filesystem;
using calib::Panel;
using kernels::GrayImage;
using Words = std::vector<std::string>;

constexpr int kTruthScale = 2;  // grey levels per disparity of the truth at half size
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

// Levels 0 .. `disparities` - 1 in colours, 255 in light grey.
Panel disparity_panel(const std::string& caption, const GrayImage& image, int disparities,
                      const std::string& missing) {
  cv::Mat1f values(image.height, image.width);
  std::transform(image.pixels.begin(), image.pixels.end(), values.begin(), [](std::uint8_t level) {
    return level == kernels::kInvalidDisparity ? std::numeric_limits<float>::quiet_NaN()
                                               : static_cast<float>(level);
  });
  return {caption, calib::with_scale(calib::in_colors(values, 0, disparities - 1),
                                     {"0", std::to_string(disparities - 1), missing})};
}

Panel depth_panel(const std::vector<std::uint16_t>& millimetres, int width, int height) {
  const auto [near, far] = calib::depth_range(millimetres).value();
  cv::Mat1f values(height, width);
  std::transform(millimetres.begin(), millimetres.end(), values.begin(), [](std::uint16_t depth) {
    return depth == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(depth);
  });
  return {"depth", calib::with_scale(calib::in_colors(values, far, near),
                                     {fmt::format("{} mm", far), fmt::format("{} mm", near), "no answer"})};
}

void write_panels(const fs::path& path, const std::vector<Panel>& panels) {
  write_file(path, calib::encode_panels_png(panels));
}

void prepare(const fs::path& source, const fs::path& out) {
  const auto picture = [&source](const char* name) {
    return middle_at_half_size(media::load_gray((source / name).string()).image);
  };
  const GrayImage left = picture("aloeL.jpg");
  const GrayImage right = picture("aloeR.jpg");
  const GrayImage truth = middle_at_half_size(media::load_gray((source / "aloeGT.png").string()).image, true);
  fs::create_directories(out);
  write_file(out / "left.png", media::encode_png_gray(left));
  write_file(out / "right.png", media::encode_png_gray(right));
  write_file(out / "truth.png", media::encode_png_gray(truth));
  std::printf("%.0f\n", media::disparities_needed({truth, kTruthScale}));
}

// The truth rounded to whole disparities (halves up). Invalid where it is unknown or not below `disparities`.
GrayImage nearest_disparity(const media::Truth& truth, int disparities) {
  GrayImage result(truth.width, truth.height, kernels::kInvalidDisparity);
  for (std::size_t i = 0; i < truth.levels.size(); ++i) {
    const double nearest = std::floor(truth.levels[i] / truth.scale + 0.5);
    if (nearest < disparities) result.pixels[i] = static_cast<std::uint8_t>(nearest);
  }
  return result;
}

void montage(const Words& words) {
  const int disparities = kernels::kDisparitiesRule.required("DISPARITIES", std::stoi(words[3]));
  std::vector<Panel> panels = {
      {"left picture", calib::in_grey(media::load_gray(words[1]).image)},
      disparity_panel("disparity, pixels", media::load_gray(words[2]).image, disparities, "no answer")};
  if (words.size() == 5) {
    const auto truth = nearest_disparity(media::load_truth(words[4], kTruthScale), disparities);
    panels.push_back(disparity_panel("ground truth, pixels", truth, disparities, "unknown"));
  }
  write_panels(words[0], panels);
}

void depth_montage(const Words& words) {
  const auto picture = media::load_gray(words[1]).image;
  const fs::path rig = words[2];
  const calib::Calibration calibration = calib::parse_calibration(files::read_whole_file(rig));
  const fs::path lut = rig.parent_path() / (rig.stem().string() + "_left.lut");
  const auto table = calib::parse_lut(files::read_whole_file(lut), picture.width, picture.height);
  const auto disparity = media::load_gray((fs::path(words[3]) / "disparity.png").string()).image;
  const calib::DepthGeometry geometry = {calibration.rectification.q, calibration.disparity_offset};
  write_panels(
      words[0],
      {{"left picture", calib::in_grey(picture)},
       {"rectified by the left table", calib::in_grey(kernels::rectify(picture, table))},
       disparity_panel("disparity, pixels", disparity, calibration.disparities, "no answer"),
       depth_panel(calib::depth_millimetres(geometry, disparity), disparity.width, disparity.height)});
}

int run(const Words& words) {
  const std::string command = words.empty() ? "" : words[0];
  const Words rest(words.begin() + (words.empty() ? 0 : 1), words.end());
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
