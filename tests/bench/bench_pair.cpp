#include "tests/bench/bench_pair.h"

#include <filesystem>
#include <random>

#include "sw/demo/demo_pictures.h"
#include "sw/media/load.h"

namespace stereotlm::bench {
namespace {

using kernels::GrayImage;

constexpr int kShift = 20;  // columns

host::StereoPair random_texture() {
  std::mt19937 random(1);
  GrayImage wide(demo::kWidth + kShift, demo::kHeight);
  for (auto& pixel : wide.pixels) pixel = static_cast<std::uint8_t>(random());
  host::StereoPair pair{GrayImage(demo::kWidth, demo::kHeight), GrayImage(demo::kWidth, demo::kHeight)};
  for (int row = 0; row < demo::kHeight; ++row) {
    for (int column = 0; column < demo::kWidth; ++column) {
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
  auto aloe = demo::make_demo_pair(media::load_gray((pictures / "aloeL.jpg").string()).image,
                                   media::load_gray((pictures / "aloeR.jpg").string()).image,
                                   media::load_truth((pictures / "aloeGT.png").string(), 1).grey);
  return {{std::move(aloe.left), std::move(aloe.right)}, "aloe"};
}

}  // namespace stereotlm::bench
