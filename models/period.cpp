#include "models/period.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace stereotlm {
namespace {

Wide power_of_ten(int exponent) {
  Wide power = 1;
  for (; exponent > 0; --exponent) power *= 10;
  return power;
}

}  // namespace

// std::to_chars() writes `value` as "d.ddde-dd", with at most 17 digits.
DecimalNumber decimal_of(double value) {
  std::array<char, 32> text{};
  const char* end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific).ptr;
  std::uint64_t digits = 0;
  int decimals = -1;  // digits behind the decimal point
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

Period::Period(Wide numerator, Wide denominator)
    : approximate_(static_cast<double>(numerator) / static_cast<double>(denominator)) {
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

}  // namespace stereotlm
