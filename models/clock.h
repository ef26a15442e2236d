#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "models/period.h"

namespace stereotlm {

// A clock without drift: edge k lies at round(k * 10^6 / f_mhz) ps, halves up (contract section 3). f_mhz is
// the decimal number as written, not the binary number nearest to it. Plain C++.
class Clock {
 public:
  // Throws std::invalid_argument unless 0.001 <= mhz <= 1000.
  explicit Clock(double mhz) : Clock(decimal_of(checked(mhz))) {}

  // Time of edge number `edge`, in ps.
  std::uint64_t edge_ps(std::uint64_t edge) const { return period_.times(edge); }
  // Number of the first edge at or after a time in ps.
  std::uint64_t edge_at_or_after(std::uint64_t time_ps) const {
    auto [edge, certain] = periods_.in(time_ps);
    if (certain) return edge + 1;
    while (edge > 0 && edge_ps(edge - 1) >= time_ps) --edge;
    while (edge_ps(edge) < time_ps) ++edge;
    return edge;
  }

  // Whether the time of a number of cycles is the same from each edge on.
  bool has_whole_period() const { return period_.is_whole(); }
  // Whether all edges of both clocks lie at the same times.
  bool has_edges_of(const Clock& other) const { return period_ == other.period_; }
  // Whether the frequency of `other` is a multiple of this one: each edge lies at one of `other`.
  bool divides(const Clock& other) const {
    return other.mhz_.numerator * mhz_.denominator % (mhz_.numerator * other.mhz_.denominator) == 0;
  }

 private:
  static double checked(double mhz) {
    if (mhz >= 0.001 && mhz <= 1000) return mhz;
    throw std::invalid_argument("clock_mhz = " + std::to_string(mhz) + ": must be 0.001..1000");
  }
  explicit Clock(const DecimalNumber& mhz)
      : mhz_(mhz),
        period_(Wide{1'000'000} * mhz.denominator, mhz.numerator),
        periods_(Wide{1'000'000} * mhz.denominator, mhz.numerator) {}

  DecimalNumber mhz_;
  Period period_;
  PeriodCounter periods_;
};

}  // namespace stereotlm
