#include "models/period.h"

#include <array>
#include <charconv>

namespace stereotlm {
namespace {

Wide power_of_ten(int exponent) {
  Wide power = 1;
  for (; exponent > 0; --exponent) power *= 10;
  return power;
}

// Returns a / b in 2^-64, rounded down. a < b < 2^127.
std::uint64_t fraction_of(Wide a, Wide b) {
  std::uint64_t fraction = 0;
  for (int bit = 0; bit < 64; ++bit) {
    a <<= 1U;
    fraction <<= 1U;
    if (a >= b) {
      a -= b;
      ++fraction;
    }
  }
  return fraction;
}

// Both are greater than 0.
Wide greatest_common_divisor(Wide a, Wide b) {
  while (b != 0) {
    const Wide rest = a % b;
    a = b;
    b = rest;
  }
  return a;
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

Period::Period(Wide numerator, Wide denominator) {
  const Wide divisor = greatest_common_divisor(numerator, denominator);
  denominator_ = denominator / divisor;
  whole_ = static_cast<std::uint64_t>(numerator / denominator);
  rest_ = numerator / divisor % denominator_;
  fraction_ = fraction_of(rest_, denominator_);
}

// The number of half ps in the rest, 2 * rest_ * count / denominator_, has a dividend that may have more than
// 128 bits. The product with the upper bits of the count is therefore divided first.
std::uint64_t Period::exact_times(std::uint64_t count) const {
  constexpr unsigned kLowerBits = 20;
  const Wide upper = 2 * rest_ * (count >> kLowerBits);
  const Wide lower = 2 * rest_ * (count & ((std::uint64_t{1} << kLowerBits) - 1));
  const Wide remainder = upper % denominator_ << kLowerBits;
  const auto half_ps =
      static_cast<std::uint64_t>(((upper / denominator_) << kLowerBits) + (remainder + lower) / denominator_);
  return whole_ * count + (half_ps + 1) / 2;
}

PeriodCounter::PeriodCounter(Wide numerator, Wide denominator)
    : per_ps_(fraction_of(denominator, numerator)) {}

}  // namespace stereotlm
