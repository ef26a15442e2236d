#include "models/kernels/stereo.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/kernels/reference_types.h"

namespace stereotlm::kernels {
namespace {

TEST(StereoConfig, NamesTheRuleThatItBreaks) {
  const auto found = [](int window, int disparities, std::optional<int> tolerance) {
    return problems(StereoConfig{window, disparities, log7(), tolerance});
  };
  using Problems = std::vector<std::string>;
  EXPECT_EQ(problems(StereoConfig{}), Problems());
  EXPECT_EQ(found(3, 1, 0), Problems());
  EXPECT_EQ(found(31, 254, 253), Problems());
  EXPECT_EQ(found(7, 80, std::nullopt), Problems());
  for (const int window : {1, 2, 4, 30, 32, 33})
    EXPECT_EQ(found(window, 80, 0), Problems{"window = " + std::to_string(window) + ": must be 3..31, odd"});
  EXPECT_EQ(found(7, 0, 0), Problems{"disparities = 0: must be 1..254"});
  EXPECT_EQ(found(7, 255, 0), Problems{"disparities = 255: must be 1..254"});
  EXPECT_EQ(found(7, 80, -1), Problems{"lr_tolerance = -1: must be 0..253"});
  EXPECT_EQ(found(7, 80, 254), Problems{"lr_tolerance = 254: must be 0..253"});
  StereoConfig config;
  config.filter->shift = 32;
  EXPECT_EQ(problems(config), Problems{"filter: shift = 32: must be 0..31"});
  EXPECT_EQ(found(1, 0, -1).size(), 3U);
  config = {};
  config.cost = {CostKind::kCensus, 4};
  EXPECT_EQ(problems(config), Problems{"cost: census_size = 4: must be 3..7, odd"});
}

TEST(Stereo, RefusesDifferentSizesAndBrokenRules) {
  const GrayImage image(8, 5);
  const RectificationTable table = identity_table(8, 5);
  const StereoConfig config;
  EXPECT_NO_THROW(disparity_image(image, image, &table, &table, config));
  EXPECT_THROW(disparity_image(image, GrayImage(8, 4), nullptr, nullptr, config), std::invalid_argument);
  EXPECT_THROW(disparity_image(GrayImage(4, 5), image, nullptr, nullptr, config), std::invalid_argument);
  EXPECT_NO_THROW(test::match(image, image, 3, 254));
  EXPECT_THROW(test::match(image, image, 3, 2, {CostKind::kCensus, 9}), std::invalid_argument);
  EXPECT_THROW(test::match(image, image, 3, 2, {CostKind::kSsd, 3}), std::invalid_argument);
  for (const auto& [window, disparities] :
       {std::pair(1, 2), std::pair(4, 2), std::pair(33, 2), std::pair(3, 0), std::pair(3, 255)})
    EXPECT_THROW(test::match(image, image, window, disparities), std::invalid_argument);
  RectificationTable broken = table;
  broken.entries[3] = make_entry(8, 0);
  for (const RectificationTable& bad : {identity_table(8, 4), broken}) {
    EXPECT_THROW(disparity_image(image, image, &bad, &table, config), std::invalid_argument);
    EXPECT_THROW(disparity_image(image, image, &table, &bad, config), std::invalid_argument);
  }
  EXPECT_THROW(disparity_image(image, image, nullptr, nullptr, {1, 80, log7(), 0}), std::invalid_argument);
  FilterKernel kernel = log7();
  kernel.size = 5;
  EXPECT_THROW(test::filter_image(image, kernel), std::invalid_argument);
  EXPECT_THROW(test::filter_image(GrayImage(), log7()), std::invalid_argument);
  EXPECT_EQ(test::filter_image(GrayImage(1, 1, 7), log7()), GrayImage(1, 1, 128));
}

}  // namespace
}  // namespace stereotlm::kernels
