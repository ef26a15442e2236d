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

// Returns 2 * rest_ * count / denominator_. The dividend may have more than 128 bits, so the product with the
// upper bits of the count is divided first.
std::uint64_t Period::doubled_rest_of(std::uint64_t count) const {
  constexpr unsigned kLowerBits = 20;
  const Wide upper = 2 * rest_ * (count >> kLowerBits);
  const Wide lower = 2 * rest_ * (count & ((std::uint64_t{1} << kLowerBits) - 1));
  const Wide remainder = upper % denominator_ << kLowerBits;
  return static_cast<std::uint64_t>(((upper / denominator_) << kLowerBits) +
                                    (remainder + lower) / denominator_);
}

}  // namespace stereotlm
