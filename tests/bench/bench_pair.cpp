#include "tests/bench/bench_pair.h"

#include <filesystem>
#include <random>

#include "sw/demo/half_size.h"
#include "sw/media/load.h"

namespace stereotlm::bench {
namespace {

using kernels::GrayImage;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr int kShift = 20;  // columns

host::StereoPair random_texture() {
  std::mt19937 random(1);
  GrayImage wide(kWidth + kShift, kHeight);
  for (auto& pixel : wide.pixels) pixel = static_cast<std::uint8_t>(random());
  host::StereoPair pair{GrayImage(kWidth, kHeight), GrayImage(kWidth, kHeight)};
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      pair.left.at(column, row) = wide.at(column, row);
      pair.right.at(column, row) = wide.at(column + kShift, row);
    }
  }
  return pair;
}

}  // namespace

BenchPair bench_pair(const std::string& folder) {
  const std::filesystem::path pictures(folder);
  if (!std::filesystem::exists(pictures / "aloeL.jpg")) return {random_texture(), "random texture"};
  const auto side = [&pictures](const char* name) {
    return demo::middle_at_half_size(media::load_gray((pictures / name).string()).image);
  };
  return {{side("aloeL.jpg"), side("aloeR.jpg")}, "aloe"};
}

}  // namespace stereotlm::bench
