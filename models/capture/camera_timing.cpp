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
      steps_per_ps_(35.0 / 32e12 * static_cast<double>(row_steps_) * config.height * config.frame_rate_hz) {}

int CameraTiming::pixels_by(int row, std::uint64_t since_begin_ps) const {
  const double steps = static_cast<double>(since_begin_ps) * steps_per_ps_;
  const double row_steps = static_cast<double>(row_steps_ * static_cast<std::uint64_t>(row));
  constexpr double kPixelsPerStep = 1.0 / kPixelSteps;
  const double arrived = (steps - row_steps) * kPixelsPerStep + 1;
  int pixels = static_cast<int>(std::clamp(arrived, 0.0, static_cast<double>(width_)));
  // Rounding moves an arrival by at most half a ps. The estimate is therefore certain if it lies farther from
  // an arrival than 1 ps plus the error of `steps`.
  const double doubt = (steps_per_ps_ + steps * 0x1p-49) * kPixelsPerStep;
  const double past_pixel = arrived - pixels;
  if (past_pixel > doubt && past_pixel < 1 - doubt) return pixels;
  while (pixels > 0 && pixel_ps(pixels - 1, row) > since_begin_ps) --pixels;
  while (pixels < width_ && pixel_ps(pixels, row) <= since_begin_ps) ++pixels;
  return pixels;
}

}  // namespace stereotlm::capture
