#pragma once

#include <array>
#include <cstdint>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// A moving scene whose disparities are known: a far wall, a floor that comes nearer towards the bottom, and
// boxes at several depths in front of them that move from frame to frame and bounce at the border of the left
// picture. All are textured with noise, as seen by two ideal cameras: without noise of their own, and a point
// at column x of the left picture is at column x - d of the right one, unless something nearer hides it
// there.
//
// Integer arithmetic and a generator of its own (SplitMix64): the same pictures on every machine. Any frame
// can be asked for at any time; there is no last one.
class SyntheticScene {
 public:
  // For a board of this size and number of candidates; disparities are 1 .. disparities-1, at most a quarter
  // of the width (all 0 if disparities = 1). Throws std::invalid_argument if the size or the disparities
  // break the rules of a board.
  SyntheticScene(std::uint64_t seed, int width, int height, int disparities);

  struct Frame {
    kernels::GrayImage left;
    kernels::GrayImage right;
    kernels::GrayImage
        disparity;  // left-referenced, of every pixel, also where the right camera cannot see it
  };
  // Costs about 15 ms at 640x480.
  Frame frame(std::uint64_t number) const;

 private:
  // A movement along one axis, to and fro between 0 and `range`.
  struct Path {
    std::uint64_t range = 0;  // pixels
    std::uint64_t start = 0;  // way covered at frame 0, 0 .. 2 * range - 1
    std::uint64_t speed = 0;  // pixels a frame

    int at(std::uint64_t frame) const;
  };
  struct Box {
    int width = 0;
    int height = 0;
    int disparity = 0;
    Path column;  // of its left edge in the left picture
    Path row;     // of its upper edge
    std::uint64_t texture = 0;
  };

  int background_disparity(int row) const;
  void draw_background(Frame& frame) const;
  void draw(const Box& box, std::uint64_t number, Frame& frame) const;

  int width_;
  int height_;
  int far_ = 0;         // disparity of the wall
  int floor_near_ = 0;  // disparity of the floor just below the picture
  std::uint64_t background_texture_ = 0;
  std::array<Box, 5> boxes_;  // the farthest first
};

}  // namespace stereotlm::media
