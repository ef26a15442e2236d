#pragma once

#include <array>
#include <cstdint>

#include "models/kernels/gray_image.h"

namespace stereotlm::media {

// A moving scene with known disparities: a far wall, a floor that rises towards the viewer, and boxes at
// several depths that move from frame to frame and bounce at the border of the left picture. All surfaces
// have a noise texture. Two ideal cameras without noise see them: a point at column x of the left picture is
// at column x - d of the right one, unless something nearer hides it.
//
// Uses integer arithmetic and SplitMix64, so that the pictures are equal on every machine. Frames can be
// requested in any order, without limit.
class SyntheticScene {
 public:
  // A scene for a board with images of this size. Its disparities are 1 .. min(disparities - 1, width / 4),
  // or all 0 if that is 0. Throws std::invalid_argument if the arguments break the rules of a board.
  SyntheticScene(std::uint64_t seed, int width, int height, int disparities);

  // The pictures of both cameras, and their ground truth.
  struct Frame {
    kernels::GrayImage left;
    kernels::GrayImage right;
    // Referenced to the left picture. Pixels that the right camera cannot see have their disparities too.
    kernels::GrayImage disparity;
  };
  // Costs about 15 ms at 640x480.
  Frame frame(std::uint64_t number) const;

 private:
  // A movement along one axis, back and forth between 0 and `range`.
  struct Path {
    std::uint64_t range = 0;  // pixels
    std::uint64_t start = 0;  // phase at frame 0, 0 .. 2 * range - 1
    std::uint64_t speed = 0;  // pixels per frame

    int at(std::uint64_t frame) const;
  };
  struct Box {
    int width = 0;
    int height = 0;
    int disparity = 0;
    Path column;  // column of its left edge in the left picture
    Path row;     // row of its upper edge
    std::uint64_t texture = 0;
  };

  void draw(const Box& box, std::uint64_t number, Frame& frame) const;

  int width_;
  int height_;
  int far_ = 0;         // disparity of the wall
  int floor_near_ = 0;  // disparity of the floor just below the picture
  std::uint64_t background_texture_ = 0;
  std::array<Box, 5> boxes_;  // farthest first
};

}  // namespace stereotlm::media
