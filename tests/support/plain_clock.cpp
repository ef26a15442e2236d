#include "tests/support/plain_clock.h"

namespace stereotlm::test {
namespace {

__extension__ typedef __int128 Wide;

// Halves up.
PlainTime rounded(Wide numerator, Wide denominator) {
  return static_cast<PlainTime>((2 * numerator + denominator) / (2 * denominator));
}

}  // namespace

PlainNumber plain_number(const std::string& decimal) {
  PlainNumber number{0, 1};
  bool has_point = false;
  for (const char c : decimal) {
    if (c == '.') {
      has_point = true;
    } else {
      number.numerator = number.numerator * 10 + (c - '0');
      if (has_point) number.denominator *= 10;
    }
  }
  return number;
}

PlainTime PlainClock::edge(std::uint64_t number) const {
  return rounded(Wide{1'000'000} * static_cast<Wide>(number) * mhz_.denominator, mhz_.numerator);
}

std::uint64_t PlainClock::first_edge(PlainTime time) const {
  const Wide before = static_cast<Wide>(time) * mhz_.numerator / (Wide{1'000'000} * mhz_.denominator);
  auto number = static_cast<std::uint64_t>(before);
  while (number > 0 && edge(number - 1) >= time) --number;
  while (edge(number) < time) ++number;
  return number;
}

PlainTime plain_frame_ps(const PlainNumber& rate_hz, std::uint64_t number) {
  return rounded(Wide{1'000'000'000'000} * static_cast<Wide>(number) * rate_hz.denominator,
                 rate_hz.numerator);
}

PlainTime plain_pixel_ps(const PlainCamera& camera, int column, int row) {
  // (row + column / width * 52.15 / 63.56) line times of 10^12 / rate / (525 / 480 * height) ps
  const Wide width = camera.width;
  const Wide lines = row * width * 6356 + Wide{column} * 5215;  // of 6356 * width
  return rounded(lines * 480 * 1'000'000'000'000 * camera.rate_hz.denominator,
                 width * 6356 * 525 * camera.height * camera.rate_hz.numerator);
}

}  // namespace stereotlm::test
