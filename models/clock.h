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
  explicit Clock(double mhz) : Clock(mhz, decimal_of(checked(mhz))) {}

  // Time of edge number `edge`, in ps.
  std::uint64_t edge_ps(std::uint64_t edge) const { return period_.times(edge); }
  // Number of the first edge at or after a time in ps.
  std::uint64_t edge_at_or_after(std::uint64_t time_ps) const {
    const double edges = static_cast<double>(time_ps) * edges_per_ps_;
    auto edge = static_cast<std::uint64_t>(edges);
    // Rounding moves an edge by at most half a ps. The estimate is therefore certain if it lies farther from
    // an edge than 1 ps plus the error of `edges`.
    const double past_edge = edges - static_cast<double>(edge);
    const double doubt = edges_per_ps_ + edges * 0x1p-50;
    if (past_edge > doubt && past_edge < 1 - doubt) return edge + 1;
    while (edge > 0 && edge_ps(edge - 1) >= time_ps) --edge;
    while (edge_ps(edge) < time_ps) ++edge;
    return edge;
  }

  // Whether all edges of both clocks lie at the same times.
  bool has_edges_of(const Clock& other) const { return period_ == other.period_; }

 private:
  static double checked(double mhz) {
    if (mhz >= 0.001 && mhz <= 1000) return mhz;
    throw std::invalid_argument("clock_mhz = " + std::to_string(mhz) + ": must be 0.001..1000");
  }
  Clock(double mhz, const DecimalNumber& exact_mhz)
      : period_(Wide{1'000'000} * exact_mhz.denominator, exact_mhz.numerator), edges_per_ps_(mhz / 1e6) {}

  Period period_;
  double edges_per_ps_;  // approximate
};

}  // namespace stereotlm
