#include "models/kernels/stereo_pipeline.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "models/kernels/lr_check.h"
#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"

namespace stereotlm::kernels {
namespace {

const StereoConfig& sound(const StereoConfig& config) {
  if (const auto found = problems(config); !found.empty()) throw std::invalid_argument(found.front());
  return config;
}

}  // namespace

StereoPipeline::StereoPipeline(int width, int height, const StereoConfig& config, const ImageLoops& loops)
    : width_(width),
      height_(height),
      radius_((sound(config).window - 1) / 2),
      tolerance_(config.lr_tolerance),
      loops_(loops),
      matcher_(width, height, config.window, config.disparities, config.lr_tolerance.has_value(), loops) {
  if (config.filter) filter_.emplace(width, height, *config.filter, loops);
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (Side* side : {&left_, &right_}) {
    side->rectified.resize(pixels);
    if (filter_) side->filtered.resize(pixels + ImageFilter::kPadding);
    side->disparity.resize(pixels);
  }
}

const std::uint8_t* StereoPipeline::prepare(Side& side, const std::uint8_t* image,
                                            const std::uint32_t* table) {
  if (table != nullptr) {
    loops_.rectify(image, table, width_ * height_, width_, side.rectified.data());
    image = side.rectified.data();
  }
  if (filter_) {
    filter_->run(image, side.filtered.data());
    image = side.filtered.data();
  }
  return image;
}

void StereoPipeline::run(const std::uint8_t* left, const std::uint8_t* right, const std::uint32_t* left_table,
                         const std::uint32_t* right_table, std::uint8_t* disparity) {
  const std::uint8_t* left_pixels = prepare(left_, left, left_table);
  const std::uint8_t* right_pixels = prepare(right_, right, right_table);
  matcher_.run(left_pixels, right_pixels, left_.disparity.data(), right_.disparity.data());
  check(left_table, disparity);
}

void StereoPipeline::check(const std::uint32_t* left_table, std::uint8_t* disparity) const {
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  std::copy_n(left_.disparity.data(), pixels, disparity);
  if (tolerance_) {
    // Inside this frame every pixel has a left-based disparity, which points to a pixel inside it.
    for (int row = radius_; row < height_ - radius_; ++row) {
      const std::ptrdiff_t begin = std::ptrdiff_t{row} * width_;
      const std::uint8_t* left_based = left_.disparity.data() + begin;
      const std::uint8_t* right_based = right_.disparity.data() + begin;
      for (int column = radius_; column < width_ - radius_; ++column) {
        const std::uint8_t d = left_based[column];
        const bool consistent = left_right_consistent(d, right_based[column - d], tolerance_);
        disparity[begin + column] = consistent ? d : kInvalidDisparity;
      }
    }
  }
  if (left_table != nullptr) {
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
      if (!entry_is_valid(left_table[pixel])) disparity[pixel] = kInvalidDisparity;
    }
  }
}

}  // namespace stereotlm::kernels
