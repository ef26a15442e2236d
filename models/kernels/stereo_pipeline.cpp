#include "models/kernels/stereo_pipeline.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "models/kernels/lr_check.h"
#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"

namespace stereotlm::kernels {
namespace {

const StereoConfig& checked(const StereoConfig& config) {
  if (const auto found = problems(config); !found.empty()) throw std::invalid_argument(found.front());
  return config;
}

}  // namespace

StereoPipeline::StereoPipeline(int width, int height, const StereoConfig& config, const Simd& simd)
    : width_(width),
      height_(height),
      radius_((checked(config).window - 1) / 2),
      tolerance_(config.lr_tolerance),
      simd_(simd.frame),
      matcher_(width, height, config.window, config.disparities, config.lr_tolerance.has_value(), config.cost,
               simd) {
  if (config.filter) filter_.emplace(width, height, *config.filter, simd);
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (Side* side : {&left_, &right_}) {
    if (filter_) side->filtered.resize(pixels + ImageFilter::kPadding);
    side->disparity.resize(pixels);
  }
  pointed_to_.resize(static_cast<std::size_t>(width));
}

const std::uint8_t* StereoPipeline::prepare(Side& side, const std::uint8_t* image,
                                            const std::uint32_t* table) {
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

void StereoPipeline::run(const std::uint8_t* left, const std::uint8_t* right, const std::uint32_t* left_table,
                         const std::uint32_t* right_table, std::uint8_t* disparity) {
  const std::uint8_t* left_pixels = prepare(left_, left, left_table);
  const std::uint8_t* right_pixels = prepare(right_, right, right_table);
  matcher_.run(left_pixels, right_pixels, left_.disparity.data(), right_.disparity.data());
  check(left_table, disparity);
}

void StereoPipeline::check(const std::uint32_t* left_table, std::uint8_t* disparity) {
  const std::size_t pixels = left_.disparity.size();
  std::copy_n(left_.disparity.data(), pixels, disparity);
  const auto invalid_if = [](bool condition) {
    return static_cast<std::uint8_t>(condition ? kInvalidDisparity : 0);
  };
  if (tolerance_) {
    // Every pixel with a window has a left-based disparity, which points to a pixel with a window.
    const int tolerance = *tolerance_;
    const int count = width_ - 2 * radius_;
    for (int row = radius_; row < height_ - radius_; ++row) {
      const std::ptrdiff_t begin = std::ptrdiff_t{row} * width_ + radius_;
      const std::uint8_t* left_based = left_.disparity.data() + begin;
      const std::uint8_t* right_based = right_.disparity.data() + begin;
      std::uint8_t* pointed_to = pointed_to_.data();
      for (int i = 0; i < count; ++i) pointed_to[i] = right_based[i - left_based[i]];
      std::uint8_t* out = disparity + begin;
      for (int i = 0; i < count; ++i)
        out[i] |= invalid_if(!left_right_consistent(left_based[i], pointed_to[i], tolerance));
    }
  }
  if (left_table != nullptr) {
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
      disparity[pixel] |= invalid_if(!entry_is_valid(left_table[pixel]));
  }
}

}  // namespace stereotlm::kernels
