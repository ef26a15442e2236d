#include "models/kernels/stereo.h"

#include <stdexcept>

#include "models/kernels/image_filter.h"
#include "models/kernels/image_matcher.h"
#include "models/kernels/stereo_pipeline.h"

namespace stereotlm::kernels {
namespace {

void require_one_size(const GrayImage& left, const GrayImage& right) {
  if (left.width != right.width || left.height != right.height) {
    throw std::invalid_argument("left image of " + std::to_string(left.width) + " x " +
                                std::to_string(left.height) + " with a right image of " +
                                std::to_string(right.width) + " x " + std::to_string(right.height) +
                                ": must be of one size");
  }
}

}  // namespace

std::vector<std::string> problems(const StereoConfig& config) {
  std::vector<std::string> found;
  kWindowRule.check("window", config.window, found);
  kDisparitiesRule.check("disparities", config.disparities, found);
  if (config.lr_tolerance) kLrToleranceRule.check("lr_tolerance", *config.lr_tolerance, found);
  if (config.filter) {
    for (const std::string& problem : problems(*config.filter)) found.push_back("filter: " + problem);
  }
  for (const std::string& problem : problems(config.cost)) found.push_back("cost: " + problem);
  return found;
}

GrayImage filter_image(const GrayImage& image, const FilterKernel& kernel) {
  ImageFilter filter(image.width, image.height, kernel);
  GrayImage filtered = image;
  filtered.pixels.resize(image.pixels.size() + ImageFilter::kPadding);
  filter.run(image.pixels.data(), filtered.pixels.data());
  filtered.pixels.resize(image.pixels.size());
  return filtered;
}

Matches match(const GrayImage& left, const GrayImage& right, int window, int disparities,
              const MatchingCost& cost) {
  require_one_size(left, right);
  ImageMatcher matcher(left.width, left.height, window, disparities, true, cost);
  Matches matches{GrayImage(left.width, left.height), GrayImage(left.width, left.height)};
  matcher.run(left.pixels.data(), right.pixels.data(), matches.left_based.pixels.data(),
              matches.right_based.pixels.data());
  return matches;
}

GrayImage disparity_image(const GrayImage& left, const GrayImage& right, const RectificationTable* left_table,
                          const RectificationTable* right_table, const StereoConfig& config) {
  require_one_size(left, right);
  for (const RectificationTable* table : {left_table, right_table})
    if (table != nullptr) require_usable(*table, left);
  StereoPipeline pipeline(left.width, left.height, config);
  const auto entries = [](const RectificationTable* table) {
    return table != nullptr ? table->entries.data() : nullptr;
  };
  GrayImage disparity(left.width, left.height);
  pipeline.run(left.pixels.data(), right.pixels.data(), entries(left_table), entries(right_table),
               disparity.pixels.data());
  return disparity;
}

}  // namespace stereotlm::kernels
