#pragma once

#include <cstdint>

#include "models/capture/capture_config.h"
#include "models/period.h"

namespace stereotlm::capture {

// When frames begin and pixels arrive, in ps (contract section 3, "Cameras"). A frame lasts 1 / frame_rate_hz
// and has 525/480 * height line times; the pixels of a line fill the first 52.15/63.56 of its line time,
// pixel i of width W arrives i/W of that after the line's beginning. The rest of each line and the lines
// behind the last are blank. Every time is rounded once, halves up, from its exact value, so nothing drifts;
// the frame rate is the decimal number that was written, not the binary one nearest to it.
class CameraTiming {
 public:
  // Throws std::invalid_argument if the configuration has problems.
  explicit CameraTiming(const CameraConfig& config);

  int width() const { return width_; }
  int height() const { return height_; }

  // From time 0 to the beginning of frame `number` of a free-running camera. A frame lasts frame_ps(1).
  std::uint64_t frame_ps(std::uint64_t number) const { return frame_.times(number); }
  // From the beginning of a frame to the arrival of a pixel in it. 0 <= column < width, 0 <= row < height.
  std::uint64_t pixel_ps(int column, int row) const {
    return step_.times(row_steps_ * static_cast<std::uint64_t>(row) +
                       kPixelSteps * static_cast<std::uint64_t>(column));
  }
  std::uint64_t row_ps(int row) const { return pixel_ps(0, row); }
  std::uint64_t last_pixel_ps() const { return pixel_ps(width_ - 1, height_ - 1); }
  // How many pixels of a row have arrived so long after the beginning of its frame; one that arrives then
  // has.
  int pixels_by(int row, std::uint64_t since_begin_ps) const;

 private:
  CameraTiming(const CameraConfig& config, const DecimalNumber& rate_hz);

  // The step is the largest time of which a line and the distance of two pixels are multiples: 52.15/63.56 =
  // 745/908.
  static constexpr std::uint64_t kPixelSteps = 745;
  static constexpr std::uint64_t kLineSteps = 908;  // per pixel of the width

  int width_;
  int height_;
  std::uint64_t row_steps_;
  Period frame_;
  Period step_;
  double steps_per_ps_;  // near enough to guess from
};

}  // namespace stereotlm::capture
