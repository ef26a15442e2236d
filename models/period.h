#pragma once

#include <cstdint>

#include "models/rounding.h"

namespace stereotlm {

__extension__ typedef unsigned __int128 Wide;

// A decimal number as an exact fraction.
struct DecimalNumber {
  Wide numerator = 0;
  Wide denominator = 1;
};

// Returns the decimal number from which `value` was parsed, taken to be the shortest one that parses to the
// same double. If 0.001 <= value <= 1000, its numerator is below 10^17 and its denominator at most 10^19.
DecimalNumber decimal_of(double value);

// A period whose length in ps is a rational number. Each multiple is rounded once, halves up, from its exact
// value, so that rounding errors do not add up.
class Period {
 public:
  // A period of numerator / denominator ps. Both are below 2^106. The denominator times the largest count is
  // below 2^146.
  Period(Wide numerator, Wide denominator);

  // The time of `count` periods, in ps.
  std::uint64_t times(std::uint64_t count) const {
    if (rest_ == 0) return whole_ * count;
    if (const auto time = rounded_if_certain(static_cast<double>(count) * approximate_)) return *time;
    // A division of 128-bit numbers takes several times as long as one of 64-bit numbers.
    const std::uint64_t doubled_rest =
        count <= narrow_counts_
            ? 2 * static_cast<std::uint64_t>(rest_) * count / static_cast<std::uint64_t>(denominator_)
            : doubled_rest_of(count);
    return whole_ * count + (doubled_rest + 1) / 2;
  }

  friend bool operator==(const Period& a, const Period& b) {
    return a.whole_ == b.whole_ && a.rest_ == b.rest_ && a.denominator_ == b.denominator_;
  }

 private:
  std::uint64_t doubled_rest_of(std::uint64_t count) const;

  double approximate_;   // ps, rounded to a double
  std::uint64_t whole_;  // whole ps
  Wide rest_;            // the rest is rest_ / denominator_ ps, in lowest terms
  Wide denominator_;
  std::uint64_t narrow_counts_;  // largest count for which 64-bit arithmetic is enough
};

}  // namespace stereotlm
