#include "models/kernels/stereo.h"

#include <stdexcept>

#include "models/kernels/stereo_pipeline.h"

namespace stereotlm::kernels {
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

GrayImage disparity_image(const GrayImage& left, const GrayImage& right, const RectificationTable* left_table,
                          const RectificationTable* right_table, const StereoConfig& config) {
  if (left.width != right.width || left.height != right.height) {
    throw std::invalid_argument("left image of " + std::to_string(left.width) + " x " +
                                std::to_string(left.height) + " with a right image of " +
                                std::to_string(right.width) + " x " + std::to_string(right.height) +
                                ": must be of one size");
  }
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
