#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/checked.h"
#include "models/kernels/image_filter.h"
#include "models/kernels/image_matcher.h"
#include "models/kernels/simd.h"
#include "models/kernels/stereo.h"
#include "models/kernels/words.h"

namespace stereotlm::kernels {

// Computes the disparity images of many frames (contract sections 1 and 7.6): rectifies, filters, matches
// and checks whole images. Used by disparity_image() and fpga::DirectFrame. The constructor allocates all
// memory, except for rectified pictures: their memory is allocated with the first table.
class StereoPipeline {
 public:
  // Throws std::invalid_argument if the configuration has problems, or if the images are empty but are to be
  // filtered. `simd`: one of simd_sets().
  StereoPipeline(int width, int height, const StereoConfig& config, const Simd& simd = best_simd())
      : width_(width),
        height_(height),
        radius_((checked(config).window - 1) / 2),
        tolerance_(config.lr_tolerance),
        simd_(simd),
        matcher_(width, height, config.window, config.disparities, config.lr_tolerance.has_value(),
                 config.cost, simd) {
    if (config.filter) filter_.emplace(width, height, *config.filter, simd);
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    for (PreparedImage* side : {&left_, &right_}) {
      if (filter_) side->filtered.resize(pixels + ImageFilter::kPadding);
      side->disparity.resize(pixels, kInvalidDisparity);
    }
  }

  // Images hold width * height pixels, tables as many entries, row-major. A null table means that its side
  // has none. Valid entries must point inside the image, which is not checked.
  void run(const std::uint8_t* left, const std::uint8_t* right, const std::uint32_t* left_table,
           const std::uint32_t* right_table, std::uint8_t* disparity) {
    const std::uint8_t* left_pixels = prepare(left_, left, left_table);
    const std::uint8_t* right_pixels = prepare(right_, right, right_table);
    matcher_.run(left_pixels, right_pixels, left_.disparity.data(), right_.disparity.data());
    check(left_table, disparity);
  }

 private:
  struct PreparedImage {
    std::vector<std::uint8_t> rectified;
    std::vector<std::uint8_t> filtered;
    std::vector<std::uint8_t> disparity;  // of the matches based on this side
  };

  const std::uint8_t* prepare(PreparedImage& side, const std::uint8_t* image, const std::uint32_t* table) {
    if (table != nullptr) {
      side.rectified.resize(side.disparity.size());
      simd_.rectify(image, table, width_ * height_, width_, side.rectified.data());
      image = side.rectified.data();
    }
    if (filter_) {
      filter_->run(image, side.filtered.data());
      image = side.filtered.data();
    }
    return image;
  }
  // Every pixel that has a window has a left-based disparity, which points to a pixel that has a window too.
  // All other pixels are invalid.
  void check(const std::uint32_t* left_table, std::uint8_t* disparity) const {
    const int windows = width_ - 2 * radius_;  // in a row
    std::ptrdiff_t end = 0;                    // of the pixels that are written
    for (int row = radius_; row < height_ - radius_ && windows > 0; ++row) {
      const std::ptrdiff_t begin = std::ptrdiff_t{row} * width_ + radius_;
      std::fill(disparity + end, disparity + begin, kInvalidDisparity);
      simd_.check_row(left_.disparity.data() + begin, tolerance_ ? right_.disparity.data() + begin : nullptr,
                      left_table != nullptr ? left_table + begin : nullptr, windows, tolerance_.value_or(0),
                      disparity + begin);
      end = begin + windows;
    }
    std::fill(disparity + end, disparity + left_.disparity.size(), kInvalidDisparity);
  }

  int width_;
  int height_;
  int radius_;
  std::optional<int> tolerance_;
  const Simd& simd_;
  std::optional<ImageFilter> filter_;
  ImageMatcher matcher_;
  PreparedImage left_;
  PreparedImage right_;
};

}  // namespace stereotlm::kernels
