#pragma once

#include <cstdint>

namespace stereotlm {

__extension__ typedef unsigned __int128 Wide;  // an integer of 0..2^128 - 1

// A decimal number as an exact fraction.
struct DecimalNumber {
  Wide numerator = 0;    // integer
  Wide denominator = 1;  // at least 1
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
    const Wide product = Wide{fraction_} * count;
    // The exact time is beyond whole ps by at least `least` and by less than `most`, in 2^-64 ps.
    const auto least = static_cast<std::uint64_t>(product);
    const std::uint64_t most = least + count;
    constexpr unsigned kHalf = 63;
    if (most < least || least >> kHalf != most >> kHalf) return exact_times(count);
    return whole_ * count + static_cast<std::uint64_t>(product >> 64U) + (least >> kHalf);
  }

  bool is_whole() const { return rest_ == 0; }  // whether its length is whole ps

  friend bool operator==(const Period& a, const Period& b) {
    return a.whole_ == b.whole_ && a.rest_ == b.rest_ && a.denominator_ == b.denominator_;
  }

 private:
  std::uint64_t exact_times(std::uint64_t count) const;

  std::uint64_t whole_;     // whole ps
  std::uint64_t fraction_;  // the rest in 2^-64 ps, rounded down
  Wide rest_;               // the rest is rest_ / denominator_ ps, in lowest terms
  Wide denominator_;
};

// Counts how many periods fit into a time.
class PeriodCounter {
 public:
  // A period of numerator / denominator ps, at least 4 ps. The numerator is below 2^127.
  PeriodCounter(Wide numerator, Wide denominator);

  // The periods in a time.
  struct Count {
    std::uint64_t whole = 0;  // whole periods
    // Whether a time up to 1 ps longer or shorter would have as many. If not, `whole` may be wrong by one.
    bool certain = false;
  };
  // `time_ps`: below 2^62.
  Count in(std::uint64_t time_ps) const {
    const Wide product = Wide{per_ps_} * time_ps;
    const auto fraction = static_cast<std::uint64_t>(product);
    const std::uint64_t doubt = 2 * per_ps_ + time_ps;
    return {static_cast<std::uint64_t>(product >> 64U), fraction > doubt && fraction < ~doubt};
  }

 private:
  std::uint64_t per_ps_;  // periods in a ps, in 2^-64, rounded down
};

}  // namespace stereotlm
