#include "sw/media/synthetic_scene.h"

#include <algorithm>

#include "calib/split_mix.h"
#include "models/fpga/core_config.h"
#include "models/kernels/limits.h"

namespace stereotlm::media {
namespace {

using kernels::GrayImage;

using calib::SplitMix;

std::uint64_t below(std::uint64_t count, SplitMix& random) { return random.next() % count; }

// The noise of a texture at this position, 0 .. 2^bits-1.
int noise(std::uint64_t texture, int column, int row, unsigned bits) {
  const std::uint64_t position = static_cast<std::uint64_t>(row) << 32U | static_cast<std::uint64_t>(column);
  return static_cast<int>(calib::mixed(texture + position * calib::kSplitMixStep) >> (64 - bits));
}

// The grey level of a texture, 24..214: the sum of noise by pixel and noise by patch of 4 x 4 pixels, so that
// no area is flat.
std::uint8_t texel(std::uint64_t texture, int column, int row) {
  return static_cast<std::uint8_t>(24 + noise(texture, column, row, 7) +
                                   noise(~texture, column / 4, row / 4, 6));
}

// A random length from one to three eighths of the side.
int size_within(int side, SplitMix& random) {
  const int part = side / 8 + static_cast<int>(below(static_cast<std::uint64_t>(side) / 4 + 1, random));
  return std::max(1, part);
}

}  // namespace

int SyntheticScene::Path::at(std::uint64_t frame) const {
  if (range == 0) return 0;
  const std::uint64_t there_and_back = 2 * range;
  const std::uint64_t way = (start + frame % there_and_back * speed) % there_and_back;
  return static_cast<int>(std::min(way, there_and_back - way));
}

SyntheticScene::SyntheticScene(std::uint64_t seed, int width, int height, int disparities)
    : width_(fpga::kWidthRule.required("width", width)),
      height_(fpga::kHeightRule.required("height", height)) {
  const int nearest = std::min(kernels::kDisparitiesRule.required("disparities", disparities) - 1, width / 4);
  far_ = std::min(nearest, std::max(1, nearest / 8));
  floor_near_ = std::max(far_, nearest / 3);
  SplitMix random(seed);
  background_texture_ = random.next();
  const auto path = [&random](int range, int side) {
    Path result;
    result.range = static_cast<std::uint64_t>(range);
    result.start = range > 0 ? below(2 * result.range, random) : 0;
    result.speed = (1 + below(3, random)) * static_cast<std::uint64_t>(std::max(1, side / 160));
    return result;
  };
  const int count = static_cast<int>(boxes_.size());
  for (int i = 0; i < count; ++i) {
    Box& box = boxes_[static_cast<std::size_t>(i)];
    box.width = size_within(width, random);
    box.height = size_within(height, random);
    box.disparity = floor_near_ + (nearest - floor_near_) * (i + 1) / count;
    box.column = path(width - box.width, width);
    box.row = path(height - box.height, height);
    box.texture = random.next();
  }
}

SyntheticScene::Frame SyntheticScene::frame(std::uint64_t number) const {
  Frame frame = {GrayImage(width_, height_), GrayImage(width_, height_), GrayImage(width_, height_)};
  for (int y = 0; y < height_; ++y) {
    const int floor_row = std::max(y - height_ / 2, 0);  // the wall is in the upper half, the floor below
    const int d = far_ + (floor_near_ - far_) * floor_row / (height_ - height_ / 2);
    for (int x = 0; x < width_; ++x) {
      frame.left.at(x, y) = texel(background_texture_, x, y);
      frame.right.at(x, y) = texel(background_texture_, x + d, y);
      frame.disparity.at(x, y) = static_cast<std::uint8_t>(d);
    }
  }
  for (const Box& box : boxes_) draw(box, number, frame);
  return frame;
}

// Draws a box over everything that was drawn before, in both pictures. The boxes are therefore drawn in the
// order of their distance, farthest first.
void SyntheticScene::draw(const Box& box, std::uint64_t number, Frame& frame) const {
  const int first_column = box.column.at(number);
  const int first_row = box.row.at(number);
  for (int v = 0; v < box.height; ++v) {
    const int y = first_row + v;
    for (int u = 0; u < box.width; ++u) {
      const int x = first_column + u;
      const std::uint8_t level = texel(box.texture, u, v);
      frame.left.at(x, y) = level;
      frame.disparity.at(x, y) = static_cast<std::uint8_t>(box.disparity);
      if (x >= box.disparity) frame.right.at(x - box.disparity, y) = level;
    }
  }
}

}  // namespace stereotlm::media
