#include "sw/runs/simulation/point_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "models/kernels/stereo_pipeline.h"
#include "sw/files/text_forms.h"
#include "sw/media/fit.h"
#include "sw/media/synthetic_scene.h"

namespace stereotlm::runs {

PointQuality::PointQuality(explore::Plan& plan, process::Problems& problems) : seeds_(plan.seeds()) {
  std::string hashes;
  std::string first;  // picture that could be read
  media::Size size;   // of it
  for (const explore::PlanPair& files : plan.pairs()) {
    Pair& pair = pairs_.emplace_back();
    const auto load = [&](const char* name, const std::string& path, const auto& read) {
      problems.attempt(fmt::format("{}: {}.{} ", files.place, explore::kPairsPath, name), [&] {
        const media::Size its = read(path);
        if (first.empty()) std::tie(first, size) = std::tie(path, its);
        if (!(its == size)) {
          throw std::runtime_error(fmt::format("'{}': {}x{} pixels: must be as large as '{}', {}x{}", path,
                                               its.width, its.height, first, size.width, size.height));
        }
        hashes += files::sha256_file(path) + '\n';
      });
    };
    const auto grey = [](kernels::GrayImage& into) {
      return [&into](const std::string& path) {
        into = media::load_gray(path).image;
        return media::size_of(into);
      };
    };
    load("left", files.left, grey(pair.pictures.left));
    load("right", files.right, grey(pair.pictures.right));
    load("truth", files.truth, [&](const std::string& path) {
      pair.truth = media::load_truth(path, files.scale);
      return media::Size{pair.truth.width, pair.truth.height};
    });
    hashes += fmt::format("{}\n", pair.truth.scale);
  }
  if (pairs_.empty() || !problems.empty()) return;
  const auto problem =
      plan.use_pairs(files::sha256_hex(hashes.data(), hashes.size()), size.width, size.height);
  if (problem)
    problems.add(fmt::format("{}: {}: {}", plan.pairs().front().place, explore::kPairsPath, *problem));
}

bool PointQuality::Known::is_same(const Known& other) const {
  const auto of = [](const Known& known) {
    const kernels::StereoConfig& its = known.config;
    return std::tie(known.width, known.height, known.left_table, known.right_table, its.window,
                    its.disparities, its.filter, its.lr_tolerance, its.cost);
  };
  return of(*this) == of(other);
}

std::optional<stats::Accuracy> PointQuality::of(const platform::BoardConfig& board,
                                                const platform::Tables* tables) {
  if (!has_pictures()) return std::nullopt;
  const fpga::CoreConfig core = core_config(board);
  Known asked;
  std::tie(asked.width, asked.height) = std::tie(core.width, core.height);
  asked.config = {core.window, core.disparities, core.filter, core.lr_tolerance, core.cost};
  if (tables != nullptr && tables->left) asked.left_table = tables->left->entries.data();
  if (tables != nullptr && tables->right) asked.right_table = tables->right->entries.data();
  const auto found = std::find_if(known_.begin(), known_.end(),
                                  [&asked](const Known& known) { return known.is_same(asked); });
  if (found != known_.end()) return found->accuracy;
  kernels::StereoPipeline pipeline(asked.width, asked.height, asked.config);
  kernels::GrayImage disparity(asked.width, asked.height);
  stats::AccuracyCounts counts;
  const auto judge = [&](const kernels::GrayImage& left, const kernels::GrayImage& right,
                         const media::Truth& truth) {
    pipeline.run(left.pixels.data(), right.pixels.data(), asked.left_table, asked.right_table,
                 disparity.pixels.data());
    counts.add(disparity, truth);
  };
  for (const Pair& pair : pairs_) judge(pair.pictures.left, pair.pictures.right, pair.truth);
  for (const std::uint64_t seed : seeds_) {
    const auto scene =
        media::SyntheticScene(seed, asked.width, asked.height, asked.config.disparities).frame(0);
    judge(scene.left, scene.right, {scene.disparity, 1});
  }
  asked.accuracy = counts.accuracy();
  known_.push_back(std::move(asked));
  return known_.back().accuracy;
}

}  // namespace stereotlm::runs
