#pragma once

#include <algorithm>
#include <cstdint>

#include "models/capture/capture_config.h"
#include "models/checked.h"
#include "models/period.h"

namespace stereotlm::capture {

// The times at which frames begin and pixels arrive, in ps (contract section 3, "Cameras"). A frame lasts
// 1/frame_rate_hz and has 525/480 * height line times. The pixels of a line fill the first 52.15/63.56 of its
// line time: pixel i of width W arrives i/W of that part after the line's beginning. The rest of each line,
// and the lines behind the last row, are blank. Each time is rounded once, halves up, from its exact value,
// so that rounding errors do not add up. The frame rate is the decimal number as written, not the binary
// number nearest to it.
class CameraTiming {
 public:
  // Throws std::invalid_argument if the configuration has problems.
  explicit CameraTiming(const CameraConfig& config)
      : CameraTiming(config, decimal_of(checked("camera", config).frame_rate_hz)) {}

  int width() const { return width_; }    // pixels
  int height() const { return height_; }  // pixels

  // Time from 0 to the beginning of frame `number` of a free-running camera. A frame lasts frame_ps(1).
  std::uint64_t frame_ps(std::uint64_t number) const { return frame_.times(number); }
  // Time from the beginning of a frame to the arrival of a pixel. 0 <= column < width, 0 <= row < height.
  std::uint64_t pixel_ps(int column, int row) const {
    return step_.times(row_steps_ * static_cast<std::uint64_t>(row) +
                       kPixelSteps * static_cast<std::uint64_t>(column));
  }
  std::uint64_t row_ps(int row) const { return pixel_ps(0, row); }  // arrival of the first pixel of a row
  std::uint64_t last_pixel_ps() const { return pixel_ps(width_ - 1, height_ - 1); }  // of the last pixel
  // Returns how many pixels of a row have arrived when `since_begin_ps` have passed since the beginning of
  // the frame. A pixel that arrives at that very time counts. Two roundings of up to half a ps can make the
  // count uncertain: then the loops correct it.
  int pixels_by(int row, std::uint64_t since_begin_ps) const {
    const std::uint64_t begin_ps = row_ps(row);
    if (since_begin_ps < begin_ps) return 0;
    const auto [periods, certain] = pixels_.in(since_begin_ps - begin_ps);
    int pixels = static_cast<int>(std::min(periods + 1, static_cast<std::uint64_t>(width_)));
    if (certain) return pixels;
    while (pixel_ps(pixels - 1, row) > since_begin_ps) --pixels;
    while (pixels < width_ && pixel_ps(pixels, row) <= since_begin_ps) ++pixels;
    return pixels;
  }

  // Pixels per second within a line.
  static double peak_pixels_per_second(const CameraConfig& config) {
    const double lines_per_second = config.frame_rate_hz * config.height * 35 / 32;
    return lines_per_second * config.width * kLineSteps / kPixelSteps;
  }

 private:
  // A frame has 525/480 = 35/32 line times per row. With a frame rate of 17 digits the step is a fraction of
  // numbers below 2^102, and a time has fewer than 2^36 steps, as Period requires.
  CameraTiming(const CameraConfig& config, const DecimalNumber& rate_hz)
      : width_(config.width),
        height_(config.height),
        row_steps_(kLineSteps * static_cast<std::uint64_t>(config.width)),
        frame_(Wide{1'000'000'000'000} * rate_hz.denominator, rate_hz.numerator),
        step_(Wide{32'000'000'000'000} * rate_hz.denominator,
              Wide{35} * row_steps_ * static_cast<std::uint64_t>(config.height) * rate_hz.numerator),
        pixels_(Wide{32'000'000'000'000} * kPixelSteps * rate_hz.denominator,
                Wide{35} * row_steps_ * static_cast<std::uint64_t>(config.height) * rate_hz.numerator) {}

  // Times are counted in steps. A step divides both a line time and the time between two pixels, for every
  // width: the pixels fill 52.15/63.56 = 745/908 of a line time.
  static constexpr std::uint64_t kPixelSteps = 745;  // steps between two pixels
  static constexpr std::uint64_t kLineSteps = 908;   // steps of a line time, for each pixel of the width

  int width_;
  int height_;
  std::uint64_t row_steps_;  // steps of a line time
  Period frame_;
  Period step_;
  PeriodCounter pixels_;  // time between two pixels of a row
};

}  // namespace stereotlm::capture
