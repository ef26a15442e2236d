#pragma once
#include <algorithm>
#include "models/kernels/stereo.h"
namespace stereotlm::kernels {
class StereoPipeline {
 public:
  StereoPipeline(int width, int height, const StereoConfig& config) : width_(width), height_(height), config_(config) {}
  void run(const std::uint8_t* left, const std::uint8_t* right, const std::uint32_t* left_table, const std::uint32_t* right_table, std::uint8_t* disparity) {
    const auto n = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    GrayImage l(width_, height_), r(width_, height_);
    std::copy_n(left, n, l.pixels.begin()); std::copy_n(right, n, r.pixels.begin());
    const auto table = [&](const std::uint32_t* t) { RectificationTable x{width_, height_, {}}; if (t) x.entries.assign(t, t + n); return x; };
    const auto lt = table(left_table), rt = table(right_table);
    const auto out = disparity_image(l, r, left_table ? &lt : nullptr, right_table ? &rt : nullptr, config_);
    std::copy_n(out.pixels.begin(), n, disparity);
  }
 private:
  int width_, height_;
  StereoConfig config_;
};
}
