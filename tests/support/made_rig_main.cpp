// Pictures of a SyntheticRig, for scripts that run `stereotlm calibrate`.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/calibration.h"
#include "sw/files/whole_file.h"
#include "sw/media/encode.h"
#include "tests/support/synthetic_rig.h"

namespace stereotlm::test {
namespace {

constexpr const char* kUsage =
    "usage: stereotlm-made-rig grid FOLDER SEED COLUMNS ROWS SQUARE_MM PAIRS\n"
    "         left_NN.png, right_NN.png of a grid, scene_left.png and scene_right.png; prints the baseline\n"
    "       stereotlm-made-rig truth F.png SEED CALIBRATION.yaml SCALE\n"
    "         the disparities of the scene with this calibration, SCALE grey levels each; 0: no match\n";

void write_png(const std::filesystem::path& path, const kernels::GrayImage& image) {
  const auto bytes = media::encode_png_gray(image);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

SyntheticRig rig_of(const std::string& seed) { return {std::stoull(seed), 640, 480}; }

void write_pictures(const std::vector<std::string>& words) {
  const std::filesystem::path folder = words.at(1);
  const SyntheticRig rig = rig_of(words.at(2));
  const calib::GridShape grid = {std::stoi(words.at(3)), std::stoi(words.at(4)), std::stod(words.at(5))};
  for (int number = 0; number < std::stoi(words.at(6)); ++number) {
    const SyntheticRig::Pair pair = rig.grid_view(grid, number);
    char name[20];
    std::snprintf(name, sizeof name, "_%02d.png", number);
    write_png(folder / ("left" + std::string(name)), pair.left);
    write_png(folder / ("right" + std::string(name)), pair.right);
  }
  const SyntheticRig::Pair scene = rig.scene();
  write_png(folder / "scene_left.png", scene.left);
  write_png(folder / "scene_right.png", scene.right);
  std::printf("%.6f\n", rig.rig().translation.norm());
}

void write_truth(const std::vector<std::string>& words) {
  const calib::Calibration made = calib::parse_calibration(files::read_whole_file(words.at(3)));
  const std::vector<float> truth =
      rig_of(words.at(2)).disparity(made.rig, made.rectification, made.disparity_offset);
  kernels::GrayImage grey(made.rig.width, made.rig.height);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double level = std::floor(double{truth[i]} * std::stod(words.at(4)) + 0.5);
    if (level > 0 && level <= 255) grey.pixels[i] = static_cast<std::uint8_t>(level);
  }
  write_png(words.at(1), grey);
}

}  // namespace
}  // namespace stereotlm::test

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    if (words.size() == 7 && words[0] == "grid") {
      stereotlm::test::write_pictures(words);
    } else if (words.size() == 5 && words[0] == "truth") {
      stereotlm::test::write_truth(words);
    } else {
      std::fputs(stereotlm::test::kUsage, stderr);
      return 2;
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stereotlm-made-rig: %s\n", error.what());
    return 1;
  }
}
