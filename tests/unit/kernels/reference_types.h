#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "models/kernels/image_filter.h"
#include "models/kernels/image_matcher.h"
#include "models/kernels/stereo.h"
#include "models/kernels/words.h"
#include "tests/support/random_board.h"
#include "tests/support/reference_arithmetic.h"

// The inputs of the literal reference as the kernels take them.
namespace stereotlm::test {

inline kernels::GrayImage gray_image(const RandomBoard& board, const std::vector<std::uint8_t>& pixels) {
  kernels::GrayImage image(board.width, board.height);
  EXPECT_EQ(image.pixels.size(), pixels.size());
  image.pixels = pixels;
  return image;
}

// One pair of noise pictures with `levels` grey levels from 0 to 255.
inline RandomBoard noise_board(int width, int height, int window, SplitMix64& random, int levels = 256) {
  RandomBoard board;
  board.width = width;
  board.height = height;
  board.window = window;
  board.pictures.resize(1);
  for (auto* side : {&board.pictures[0].left, &board.pictures[0].right}) {
    for (int pixel = 0; pixel < width * height; ++pixel)
      side->push_back(static_cast<std::uint8_t>(random.between(0, levels - 1) * 255 / (levels - 1)));
  }
  return board;
}

inline std::optional<kernels::FilterKernel> filter_kernel(const std::optional<ReferenceKernel>& kernel) {
  if (!kernel) return std::nullopt;
  return kernels::FilterKernel{kernel->size, kernel->weights, kernel->shift};
}

inline std::optional<kernels::RectificationTable> table(
    const RandomBoard& board, const std::optional<std::vector<std::uint32_t>>& entries) {
  if (!entries) return std::nullopt;
  return kernels::RectificationTable{board.width, board.height, *entries};
}

inline kernels::MatchingCost matching_cost(const ReferenceCost& cost) {
  using kernels::CostKind;
  constexpr CostKind kKinds[] = {CostKind::kSad, CostKind::kSsd, CostKind::kZncc, CostKind::kCensus};
  return {kKinds[static_cast<std::size_t>(cost.kind)], cost.census_size};
}

// Every cost, for number = 0..kCosts-1.
inline constexpr int kCosts = 6;
inline ReferenceCost any_cost(int number) {
  using Kind = ReferenceCost::Kind;
  constexpr ReferenceCost kAll[kCosts] = {{Kind::kSad, 0},    {Kind::kSsd, 0},    {Kind::kZncc, 0},
                                          {Kind::kCensus, 3}, {Kind::kCensus, 5}, {Kind::kCensus, 7}};
  return kAll[number % kCosts];
}

// The filtered image (F of contract 1.2).
inline kernels::GrayImage filter_image(const kernels::GrayImage& image, const kernels::FilterKernel& kernel) {
  kernels::ImageFilter filter(image.width, image.height, kernel);
  kernels::GrayImage filtered = image;
  filtered.pixels.resize(image.pixels.size() + kernels::ImageFilter::kPadding);
  filter.run(image.pixels.data(), filtered.pixels.data());
  filtered.pixels.resize(image.pixels.size());
  return filtered;
}

// The disparities of two filtered images of one size (contract 1.3, 7.6).
struct Matches {
  kernels::GrayImage right_based;  // dR
  kernels::GrayImage left_based;   // dL
};
inline Matches match(const kernels::GrayImage& left, const kernels::GrayImage& right, int window,
                     int disparities, const kernels::MatchingCost& cost = {}) {
  kernels::ImageMatcher matcher(left.width, left.height, window, disparities, true, cost);
  const kernels::GrayImage invalid(left.width, left.height, kernels::kInvalidDisparity);
  Matches matches{invalid, invalid};
  matcher.run(left.pixels.data(), right.pixels.data(), matches.left_based.pixels.data(),
              matches.right_based.pixels.data());
  return matches;
}

inline kernels::StereoConfig stereo_config(const RandomBoard& board) {
  return {board.window, board.disparities, filter_kernel(board.filter), board.lr_tolerance,
          matching_cost(board.cost)};
}

}  // namespace stereotlm::test
