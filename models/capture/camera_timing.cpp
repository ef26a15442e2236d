#include "models/capture/camera_timing.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>

namespace stereotlm::capture {
namespace {

std::uint64_t power_of_ten(int exponent) {
  std::uint64_t power = 1;
  for (; exponent > 0; --exponent) power *= 10;
  return power;
}

}  // namespace

CameraTiming::Period::Period(Wide numerator, Wide denominator)
    : near_(static_cast<double>(numerator) / static_cast<double>(denominator)) {
  Wide divisor = denominator;
  for (Wide rest = numerator; rest != 0;) {
    const Wide next = divisor % rest;
    divisor = rest;
    rest = next;
  }
  denominator_ = denominator / divisor;
  whole_ = static_cast<std::uint64_t>(numerator / denominator);
  rest_ = numerator / divisor % denominator_;
  constexpr Wide kNarrow = UINT64_MAX;
  narrow_counts_ =
      denominator_ > kNarrow ? 0 : static_cast<std::uint64_t>(kNarrow / std::max(Wide{1}, 2 * rest_));
}

// The shortest decimal number that reads back equal, "d.ddde-dd": at most 17 digits.
CameraTiming::Rate CameraTiming::rate_of(const CameraConfig& config) {
  if (const auto found = problems(config); !found.empty())
    throw std::invalid_argument("camera: " + found.front());
  std::array<char, 32> text{};
  const char* end = std::to_chars(text.data(), text.data() + text.size(), config.frame_rate_hz,
                                  std::chars_format::scientific)
                        .ptr;
  std::uint64_t digits = 0;
  int decimals = -1;  // behind the first digit
  const char* next = text.data();
  for (; *next != 'e'; ++next) {
    if (*next == '.') continue;
    digits = digits * 10 + static_cast<std::uint64_t>(*next - '0');
    ++decimals;
  }
  int exponent = 0;
  const char* sign = next + 1;
  std::from_chars(sign + 1, end, exponent);
  decimals -= *sign == '-' ? -exponent : exponent;
  return {digits * power_of_ten(-decimals), power_of_ten(decimals)};
}

CameraTiming::CameraTiming(const CameraConfig& config) : CameraTiming(config, rate_of(config)) {}

// 525/480 lines per row are 35/32. The largest numbers, of a rate with 17 digits, stay below 2^127.
CameraTiming::CameraTiming(const CameraConfig& config, const Rate& rate)
    : width_(config.width),
      height_(config.height),
      row_steps_(kLineSteps * static_cast<std::uint64_t>(config.width)),
      frame_(Wide{1'000'000'000'000} * rate.denominator, rate.numerator),
      step_(Wide{32'000'000'000'000} * rate.denominator,
            Wide{35} * row_steps_ * static_cast<std::uint64_t>(config.height) * rate.numerator),
      steps_per_ps_(35.0 / 32e12 * static_cast<double>(row_steps_) * config.height * config.frame_rate_hz) {}

int CameraTiming::pixels_by(int row, std::uint64_t since_begin_ps) const {
  const double steps = static_cast<double>(since_begin_ps) * steps_per_ps_;
  const double row_steps = static_cast<double>(row_steps_ * static_cast<std::uint64_t>(row));
  constexpr double kPixelsPerStep = 1.0 / kPixelSteps;
  const double arrived = (steps - row_steps) * kPixelsPerStep + 1;
  int pixels = static_cast<int>(std::clamp(arrived, 0.0, static_cast<double>(width_)));
  // A pixel arrives up to half a ps off its exact time; twice that, and the error of `steps`, leave no doubt.
  const double doubt = (steps_per_ps_ + steps * 0x1p-49) * kPixelsPerStep;
  const double past_pixel = arrived - pixels;
  if (past_pixel > doubt && past_pixel < 1 - doubt) return pixels;
  while (pixels > 0 && pixel_ps(pixels - 1, row) > since_begin_ps) --pixels;
  while (pixels < width_ && pixel_ps(pixels, row) <= since_begin_ps) ++pixels;
  return pixels;
}

}  // namespace stereotlm::capture
