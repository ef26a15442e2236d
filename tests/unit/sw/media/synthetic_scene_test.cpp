#include "sw/media/synthetic_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <stdexcept>

#include "models/kernels/stereo.h"
#include "models/kernels/words.h"

namespace stereotlm::media {
namespace {

using kernels::GrayImage;
using ::testing::Each;
using ::testing::Ge;
using ::testing::SizeIs;
using Frame = SyntheticScene::Frame;

// Whether the right camera sees what is at this pixel of the left picture, by the truth alone.
bool is_visible(const GrayImage& disparity, int x, int y) {
  const int column = x - disparity.at(x, y);
  if (column < 0) return false;
  for (int other = x + 1; other < disparity.width; ++other) {
    if (other - disparity.at(other, y) == column && disparity.at(other, y) > disparity.at(x, y)) return false;
  }
  return true;
}

// FNV-1a, 64 bit.
std::uint64_t sum_of(const Frame& frame) {
  std::uint64_t sum = 0xCBF29CE484222325U;
  for (const GrayImage* image : {&frame.left, &frame.right, &frame.disparity}) {
    for (const std::uint8_t pixel : image->pixels) sum = (sum ^ pixel) * 0x100000001B3U;
  }
  return sum;
}

TEST(SyntheticScene, IsTheSameOnEveryMachine) {
  EXPECT_EQ(sum_of(SyntheticScene(0, 64, 48, 16).frame(0)), 12750164605220251741U);
  EXPECT_EQ(sum_of(SyntheticScene(1, 640, 480, 80).frame(1'000'000)), 16971989517634503416U);
}

TEST(SyntheticScene, ShiftsWhatBothCamerasSeeByTheDisparity) {
  for (const auto& [width, height, disparities] :
       {std::array{64, 48, 16}, {320, 240, 60}, {4, 1, 2}, {2048, 2, 254}, {8, 100, 254}, {160, 120, 1}}) {
    for (const std::uint64_t number : {0U, 1U, 17U}) {
      const Frame frame = SyntheticScene(5, width, height, disparities).frame(number);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          if (!is_visible(frame.disparity, x, y)) continue;
          const int column = x - frame.disparity.at(x, y);
          ASSERT_EQ(frame.left.at(x, y), frame.right.at(column, y)) << x << ' ' << y << " of " << width;
        }
      }
    }
  }
}

TEST(SyntheticScene, IsMatchedByTheBoardsArithmetic) {
  for (const auto& [width, height, disparities] :
       {std::array{320, 240, 40}, {640, 480, 80}, {160, 120, 20}}) {
    for (const std::uint64_t number : {0U, 40U}) {
      const Frame frame = SyntheticScene(number + 1, width, height, disparities).frame(number);
      kernels::StereoConfig config;
      config.disparities = disparities;
      const GrayImage found = kernels::disparity_image(frame.left, frame.right, nullptr, nullptr, config);
      int visible = 0;
      int answered = 0;
      int right = 0;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          if (!is_visible(frame.disparity, x, y)) continue;
          ++visible;
          if (found.at(x, y) == kernels::kInvalidDisparity) continue;
          ++answered;
          right += std::abs(found.at(x, y) - frame.disparity.at(x, y)) <= 1 ? 1 : 0;
        }
      }
      EXPECT_GT(answered, visible * 80 / 100) << width;
      EXPECT_GT(right, answered * 95 / 100) << width;
    }
  }
}

TEST(SyntheticScene, HasSeveralDepthsWithinTheCandidates) {
  for (const int disparities : {254, 80, 16, 4, 2}) {
    for (const std::uint64_t seed : {0U, 1U, 2U}) {
      const GrayImage truth = SyntheticScene(seed, 640, 480, disparities).frame(0).disparity;
      const std::set<int> depths(truth.pixels.begin(), truth.pixels.end());
      EXPECT_THAT(depths, SizeIs(Ge(static_cast<std::size_t>(std::min(disparities - 1, 5)))));
      EXPECT_GE(*depths.begin(), 1);
      EXPECT_LT(*depths.rbegin(), disparities);
    }
  }
  EXPECT_THAT(SyntheticScene(1, 640, 480, 1).frame(0).disparity.pixels, Each(0));
  // Disparities stay below a quarter of the width.
  const GrayImage narrow = SyntheticScene(1, 64, 48, 254).frame(0).disparity;
  EXPECT_EQ(*std::max_element(narrow.pixels.begin(), narrow.pixels.end()), 16);
}

TEST(SyntheticScene, MovesFromEachFrameToTheNext) {
  const SyntheticScene scene(3, 64, 48, 16);
  Frame last = scene.frame(0);
  for (std::uint64_t number = 1; number < 300; ++number) {
    Frame frame = scene.frame(number);
    EXPECT_NE(frame.left, last.left) << number;
    EXPECT_NE(frame.right, last.right) << number;
    EXPECT_NE(frame.disparity, last.disparity) << number;
    last = std::move(frame);
  }
}

TEST(SyntheticScene, DiffersFromSeedToSeed) {
  std::set<std::uint64_t> sums;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    sums.insert(sum_of(SyntheticScene(seed, 64, 48, 16).frame(0)));
  EXPECT_THAT(sums, SizeIs(100));
}

TEST(SyntheticScene, RefusesSizesThatNoBoardHas) {
  for (const auto& [width, height, disparities] : {std::array{66, 48, 16},
                                                   {0, 48, 16},
                                                   {8196, 48, 16},
                                                   {64, 0, 16},
                                                   {64, 8193, 16},
                                                   {64, 48, 0},
                                                   {64, 48, 255}})
    EXPECT_THROW(SyntheticScene(0, width, height, disparities), std::invalid_argument)
        << width << ' ' << height;
  EXPECT_NO_THROW(SyntheticScene(0, 4, 1, 1));
  EXPECT_NO_THROW(SyntheticScene(0, 8192, 8192, 254));
}

}  // namespace
}  // namespace stereotlm::media
