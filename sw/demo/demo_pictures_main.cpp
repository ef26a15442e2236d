// stereotlm-demo-pictures: what ./demo needs around `stereotlm run`.
#include <charconv>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "models/kernels/stereo.h"
#include "sw/demo/demo_pair.h"
#include "sw/media/encode.h"
#include "sw/media/load.h"
#include "sw/media/panels.h"
#include "sw/report/whole_file.h"

namespace stereotlm::demo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUsage =
    "usage: stereotlm-demo-pictures prepare SRC_DIR OUT_DIR\n"
    "         from aloeL.jpg, aloeR.jpg, aloeGT.png make left.png, right.png, truth.png (640x480, truth "
    "scale 2);\n"
    "         print the number of disparities that the truth needs\n"
    "       stereotlm-demo-pictures montage OUT.png LEFT DISPARITY DISPARITIES [TRUTH]\n"
    "         show the picture, the disparities (0..DISPARITIES-1, 255 = invalid) and the truth side by "
    "side\n";

// Written aside, then renamed: no partial file is left under the final name.
void write_file(const fs::path& path, const std::vector<std::uint8_t>& bytes) {
  const fs::path aside = path.string() + ".part";
  fs::remove(aside);
  report::write_whole_file(aside, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  fs::rename(aside, path);
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
  std::printf("%d\n", disparities_needed(pair.truth));
}

int parse_disparities(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const kernels::IntegerRule& rule = kernels::kDisparitiesRule;
  if (error != std::errc() || end != text.data() + text.size() || !rule.allows(value)) {
    throw std::invalid_argument("DISPARITIES = " + std::string(text) + ": must be an integer, " +
                                rule.text());
  }
  return value;
}

void montage(const std::vector<std::string>& arguments) {
  const int disparities = parse_disparities(arguments[3]);
  std::vector<media::Panel> panels = {
      {"left picture", media::load_gray(arguments[1]).image, 0},
      {"disparity (black: no answer)", media::load_gray(arguments[2]).image, disparities}};
  if (arguments.size() == 5) {
    const auto truth = media::load_truth(arguments[4], kTruthScale);
    panels.push_back(
        {"ground truth (black: unknown)", media::nearest_disparity(truth, disparities), disparities});
  }
  write_file(arguments[0], media::encode_side_by_side_png(panels));
}

int run(const std::vector<std::string>& arguments) {
  const std::string command = arguments.empty() ? "" : arguments[0];
  const std::vector<std::string> rest(arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end());
  if (command == "prepare" && rest.size() == 2) {
    prepare(rest[0], rest[1]);
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
