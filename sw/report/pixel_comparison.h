#pragma once

#include <cstdint>
#include <optional>

#include "models/kernels/gray_image.h"

namespace stereotlm::report {

// Compares the disparities of two runs, A and B, pixel by pixel.
class PixelComparison {
 public:
  // Adds the disparities of one camera frame. Throws std::invalid_argument if the sizes differ.
  void add(std::uint64_t camera_frame, const kernels::GrayImage& a, const kernels::GrayImage& b);

  std::uint64_t frames() const { return frames_; }  // frames compared
  std::uint64_t frames_that_differ() const { return frames_that_differ_; }
  std::uint64_t pixels() const { return pixels_; }  // pixels that differ, over all frames

  // The first pixel that differs: the leftmost in the topmost row of the first frame with differences.
  struct First {
    std::uint64_t camera_frame = 0;
    int column = 0;
    int row = 0;
    int a = 0;
    int b = 0;
  };
  const std::optional<First>& first() const { return first_; }

 private:
  std::uint64_t frames_ = 0;
  std::uint64_t frames_that_differ_ = 0;
  std::uint64_t pixels_ = 0;
  std::optional<First> first_;
};

}  // namespace stereotlm::report
