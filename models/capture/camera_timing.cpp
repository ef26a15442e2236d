#include "models/capture/camera_timing.h"

#include <algorithm>

#include "models/checked.h"

namespace stereotlm::capture {

CameraTiming::CameraTiming(const CameraConfig& config)
    : CameraTiming(config, decimal_of(checked("camera", config).frame_rate_hz)) {}

// A frame has 525/480 = 35/32 line times per row. With a frame rate of 17 digits the step is a fraction of
// numbers below 2^102, and a time has fewer than 2^36 steps.
CameraTiming::CameraTiming(const CameraConfig& config, const DecimalNumber& rate_hz)
    : width_(config.width),
      height_(config.height),
      row_steps_(kLineSteps * static_cast<std::uint64_t>(config.width)),
      frame_(Wide{1'000'000'000'000} * rate_hz.denominator, rate_hz.numerator),
      step_(Wide{32'000'000'000'000} * rate_hz.denominator,
            Wide{35} * row_steps_ * static_cast<std::uint64_t>(config.height) * rate_hz.numerator),
      pixels_(Wide{32'000'000'000'000} * kPixelSteps * rate_hz.denominator,
              Wide{35} * row_steps_ * static_cast<std::uint64_t>(config.height) * rate_hz.numerator) {}

// Rounding moves the beginning of the row and the arrival of a pixel by at most half a ps each.
int CameraTiming::pixels_by(int row, std::uint64_t since_begin_ps) const {
  const std::uint64_t begin_ps = row_ps(row);
  if (since_begin_ps < begin_ps) return 0;
  const auto [periods, certain] = pixels_.in(since_begin_ps - begin_ps);
  int pixels = static_cast<int>(std::min(periods + 1, static_cast<std::uint64_t>(width_)));
  if (certain) return pixels;
  while (pixel_ps(pixels - 1, row) > since_begin_ps) --pixels;
  while (pixels < width_ && pixel_ps(pixels, row) <= since_begin_ps) ++pixels;
  return pixels;
}

}  // namespace stereotlm::capture
